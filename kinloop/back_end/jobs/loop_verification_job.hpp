#pragma once
// Verifies loop hypotheses geometrically and adds those to the map in which several keyframes agree.

#include <optional>
#include <utility>
#include <vector>

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/loop/hypotheses.hpp"

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

  /// Says that these loops falsely joined visits.
  void refute(const std::vector<LoopEnds>& joins) { hypotheses_.refute(joins); }

  /// Records the first keyframe of a component and the last trusted pose before it.
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

 private:
  PlaceOptions options_;
  int lag_frames_;
  std::vector<LoopVerificationProblem> waiting_;
  LoopHypotheses hypotheses_;
  std::optional<Sensor> sensor_;  // of the latest problem
};

}  // namespace kinloop
