#pragma once
// Adds those verified loops to the map in which several keyframes agree. Before visits are joined, their
// views are compared.

#include <optional>
#include <utility>
#include <vector>

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/loop/hypotheses.hpp"

namespace kinloop {

class LoopDecisionJob {
 public:
  static constexpr const char* kName = "loop decision";
  static constexpr bool kMovesWholeMap = false;
  using Problem = JoinProblem;
  using Solution = ComparedJoins;

  LoopDecisionJob(const BackEndOptions& options, IsAliased is_aliased)
      : lag_frames_(options.executor.loop_verification_lag_frames), hypotheses_(std::move(is_aliased)) {}

  /// Decides on the verified loops of keyframes, as far as no views must be compared.
  AppliedSolution add(Map& map, const VerifiedLoops& verified);

  /// Says that the camera was falsely located in the component of this keyframe.
  void require_more_evidence(KeyframeId place) { hypotheses_.require_more_evidence(place); }

  /// Says that these loops falsely joined visits.
  void record_contradicted(const std::vector<LoopEnds>& joins) { hypotheses_.record_contradicted(joins); }

  /// Records the first keyframe of a component and the last trusted pose before it.
  void add_beginning(KeyframeId first, const CameraMotion& before) {
    hypotheses_.add_beginning(first, before);
  }

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& /*context*/) const { return hypotheses_.needs_comparison(); }
  [[nodiscard]] Problem make_problem(const JobContext& context) const {
    return hypotheses_.join_problem(context.map, context.sensor);
  }
  [[nodiscard]] static Solution solve(const Problem& problem) { return compare_rooms(problem); }
  /// Stale if the whole map has moved: components may have been parted.
  [[nodiscard]] std::optional<AppliedSolution> apply(Map& map, const Solution& compared);
  void on_stale(Solution compared) { hypotheses_.keep(std::move(compared.cache)); }

  /// Decides on the loops that wait for other keyframes, when none will come.
  AppliedSolution finish(Map& map);

 private:
  int lag_frames_;
  LoopHypotheses hypotheses_;
};

}  // namespace kinloop
