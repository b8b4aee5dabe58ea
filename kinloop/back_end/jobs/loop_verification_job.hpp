#pragma once
// Verifies loop hypotheses geometrically and adds those to the map in which several keyframes agree.

#include <optional>
#include <utility>
#include <vector>

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/loop/hypotheses.hpp"
#include "kinloop/loop/join_check.hpp"

namespace kinloop {

class LoopVerificationJob {
 public:
  static constexpr const char* kName = "loop verification";
  static constexpr bool kMovesWholeMap = false;
  struct Problem {
    std::vector<LoopVerificationProblem> keyframes;
    PlaceContext context;
  };
  using Solution = std::vector<std::vector<LoopVerificationResult>>;  ///< by keyframe

  LoopVerificationJob(const BackEndOptions& options, HasDouble has_double)
      : options_{options.tracking, options.local_map, options.loop},
        lag_frames_(options.executor.loop_verification_lag_frames),
        hypotheses_(std::move(has_double)) {}

  /// Adds hypotheses to the next job.
  void add(LoopVerificationProblem hypotheses);

  /// Says that the camera was falsely located in the component of this keyframe.
  void suspect(KeyframeId place) { hypotheses_.suspect(place); }

  /// Says when the camera began a component, see LoopHypotheses.
  void add_beginning(KeyframeId first, const TrustedPose& before) {
    hypotheses_.add_beginning(first, before);
  }

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& context) const;
  [[nodiscard]] Problem make_problem(const JobContext& context);
  [[nodiscard]] static Solution solve(const Problem& problem);
  /// Never stale: a loop closure is relative to keyframes, so it stays valid when they move.
  [[nodiscard]] std::optional<AppliedSolution> apply(Map& map, const Solution& loops);
  void on_stale(const Solution& /*loops*/) {}

  /// Decides on the loops that wait for other keyframes, when none will come.
  AppliedSolution finish(Map& map);

  /// Parts the visits that turn out to be different rooms, as their views become more.
  AppliedSolution part_different_rooms(Map& map) { return part_different_rooms(map, kMinViews); }

  /// The same when no further keyframes come.
  AppliedSolution part_different_rooms_at_end(Map& map) { return part_different_rooms(map, 0); }

 private:
  static constexpr int kMinViews = 20;

  AppliedSolution part_different_rooms(Map& map, int min_views);

  PlaceOptions options_;
  int lag_frames_;
  std::vector<LoopVerificationProblem> waiting_;
  LoopHypotheses hypotheses_;
  JoinCheck joins_;
  std::optional<Sensor> sensor_;  // of the latest problem
};

}  // namespace kinloop
