#pragma once
// Local bundle adjustment around each new keyframe.

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/mapping/bundle_adjustment.hpp"

namespace kinloop {

class LocalBaJob {
 public:
  static constexpr const char* kName = "local bundle adjustment";
  static constexpr bool kMovesWholeMap = false;
  struct Problem {
    BundleAdjustmentProblem problem;
    BundleOptions options;
  };
  using Solution = MapUpdate;

  explicit LocalBaJob(const BackEndOptions& options)
      : options_(options.mapping), lag_frames_(options.executor.local_ba_lag_frames) {}

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& context) const;
  [[nodiscard]] Problem make_problem(const JobContext& context) const;
  [[nodiscard]] static Solution solve(const Problem& problem);
  [[nodiscard]] static std::optional<AppliedSolution> apply(Map& map, const Solution& update);
  void on_stale(const Solution& /*update*/) {}

 private:
  MappingOptions options_;
  int lag_frames_;
};

}  // namespace kinloop
