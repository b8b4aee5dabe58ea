#pragma once
// Verifies loop hypotheses geometrically.

#include <optional>
#include <utility>
#include <vector>

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/loop/verification/verify_loop.hpp"

namespace kinloop {

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

}  // namespace kinloop
