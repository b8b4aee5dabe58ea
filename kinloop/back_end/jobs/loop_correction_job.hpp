#pragma once
// Loop correction: distributes the drift over all keyframes, merges the landmarks matched by loops, and takes
// back the loops that are false.

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"

namespace kinloop {

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

}  // namespace kinloop
