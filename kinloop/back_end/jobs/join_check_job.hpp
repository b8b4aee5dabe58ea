#pragma once
// Judges the joins of two visits again with each new keyframe, and takes those back that are contradicted.

#include <utility>
#include <vector>

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/loop/verification/join_check.hpp"

namespace kinloop {

class JoinCheckJob {
 public:
  static constexpr const char* kName = "join check";
  static constexpr bool kMovesWholeMap = false;
  struct Problem {
    std::vector<JoinedViews> views;
    Sensor sensor;
  };
  using Solution = std::vector<ViewPairResult>;

  explicit JoinCheckJob(const BackEndOptions& options)
      : lag_frames_(options.executor.loop_verification_lag_frames) {}

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& context) const { return joins_.has_views(context.map); }
  [[nodiscard]] Problem make_problem(const JobContext& context) {
    return {joins_.take_views(context.map), context.sensor};
  }
  [[nodiscard]] static Solution solve(const Problem& problem);
  /// Never stale: what was compared is of the visits, whatever has become of their poses.
  [[nodiscard]] std::optional<AppliedSolution> apply(Map& map, const Solution& results);
  void on_stale(const Solution& /*results*/) {}

  /// Judges by fewer views, when no further keyframes come.
  AppliedSolution finish(Map& map);

 private:
  [[nodiscard]] AppliedSolution part(Map& map, int min_views);

  int lag_frames_;
  JoinCheck joins_;
};

}  // namespace kinloop
