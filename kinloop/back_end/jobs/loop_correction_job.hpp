#pragma once
// Loop correction: distributes the drift over all keyframes and merges the landmarks matched by loops.

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/loop/correct_loop.hpp"

namespace kinloop {

class LoopCorrectionJob {
 public:
  static constexpr const char* kName = "loop correction";
  static constexpr bool kMovesWholeMap = true;
  struct Problem {
    LoopCorrectionProblem problem;
    LoopOptions options;
  };
  using Solution = MapUpdate;

  explicit LoopCorrectionJob(const BackEndOptions& options)
      : options_(options.loop), lag_frames_(options.executor.loop_correction_lag_frames) {}

  /// Requests a job, after loop closures were added to the map; `merges` are the landmarks they identify.
  void add(const LandmarkMerges& merges);

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& context) const;
  [[nodiscard]] Problem make_problem(const JobContext& context);
  [[nodiscard]] static Solution solve(const Problem& problem);
  [[nodiscard]] std::optional<AppliedSolution> apply(Map& map, const Solution& update);
  /// The loops stay in the map; their landmark merges are kept for the next job.
  void on_stale(const Solution& update);

 private:
  LoopOptions options_;
  int lag_frames_;
  bool loops_waiting_ = false;
  size_t loops_in_problem_ = 0;  // loop closures of the map when the latest problem was copied
  size_t corrected_loops_ = 0;   // of these, the ones for which the map has been corrected
  LandmarkMerges merges_;        // of the waiting loops
};

}  // namespace kinloop
