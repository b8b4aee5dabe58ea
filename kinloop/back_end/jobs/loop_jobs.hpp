#pragma once
// The jobs of a loop, in the order in which it meets them: verification, decision, correction, later checks.

#include <optional>
#include <utility>
#include <vector>

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/loop/hypotheses.hpp"
#include "kinloop/loop/verification/join_check.hpp"
#include "kinloop/loop/verification/verify_loop.hpp"

namespace kinloop {

// Verifies loop hypotheses geometrically.

class LoopVerificationJob {
 public:
  static constexpr const char* kName = "loop verification";
  static constexpr bool kMovesWholeMap = false;
  struct Problem {
    std::vector<LoopVerificationProblem> keyframes;
    PlaceContext context;
  };
  using Solution = VerifiedLoops;

  explicit LoopVerificationJob(const BackEndOptions& options)
      : options_{options.tracking, options.local_map, options.loop},
        lag_frames_(options.executor.loop_verification_lag_frames) {}

  /// Adds hypotheses to the next job.
  void add(LoopVerificationProblem hypotheses);

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& /*context*/) const { return !waiting_.empty(); }
  [[nodiscard]] Problem make_problem(const JobContext& context) {
    return {std::exchange(waiting_, {}), {context.sensor, options_}};
  }
  [[nodiscard]] static Solution solve(const Problem& problem);
  /// Never stale: a loop closure is relative to keyframes, so it stays valid when they move.
  [[nodiscard]] static std::optional<AppliedSolution> apply(Map& /*map*/, const Solution& loops) {
    return AppliedSolution{.map_changed = false, .verified = loops};
  }
  void on_stale(const Solution& /*loops*/) {}

 private:
  PlaceOptions options_;
  int lag_frames_;
  std::vector<LoopVerificationProblem> waiting_;
};

// Adds those verified loops to the map in which several keyframes agree. Before visits are joined, their
// views are compared.

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

// Loop correction: distributes the drift over all keyframes, merges the landmarks matched by loops, and takes
// back the loops that are false.

class LoopCorrectionJob {
 public:
  static constexpr const char* kName = "loop correction";
  static constexpr bool kMovesWholeMap = true;
  struct Problem {
    LoopCorrectionProblem problem;
    LoopOptions options;
  };
  using Solution = LoopCorrection;

  explicit LoopCorrectionJob(const BackEndOptions& options)
      : options_(options.loop), lag_frames_(options.executor.loop_correction_lag_frames) {}

  /// Requests a job, after loop closures were added to the map; `merges` are the landmarks they identify.
  void add(const std::vector<LoopMerges>& merges);

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& context) const;
  [[nodiscard]] Problem make_problem(const JobContext& context);
  [[nodiscard]] static Solution solve(const Problem& problem);
  [[nodiscard]] static std::optional<AppliedSolution> apply(Map& map, const Solution& correction);
  /// The loops stay in the map; their landmark merges are kept for the next job.
  void on_stale(const Solution& correction);

 private:
  LoopOptions options_;
  int lag_frames_;
  bool loops_waiting_ = false;
  std::vector<LoopMerges> merges_;  // of the waiting loops
  OdometryBeforeLoops odometry_;
};

// Judges the joins of two visits again with each new keyframe, and takes those back that are contradicted.

class JoinCheckJob {
 public:
  static constexpr const char* kName = "join check";
  static constexpr bool kMovesWholeMap = false;
  struct Problem {
    std::vector<OverlappingViews> views;
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
