#pragma once
// Bundle adjustment of the whole map after loops were corrected. Not of a large map, since copying it would
// delay the frame at which the job starts; the final adjustment follows anyway.

#include "kinloop/back_end/jobs/job_context.hpp"
#include "kinloop/mapping/bundle_adjustment.hpp"

namespace kinloop {

class GlobalBaJob {
 public:
  static constexpr const char* kName = "global bundle adjustment";
  static constexpr bool kMovesWholeMap = true;
  struct Problem {
    BundleAdjustmentProblem problem;
    BundleOptions options;
  };
  using Solution = MapUpdate;

  explicit GlobalBaJob(const BackEndOptions& options)
      : options_(options.global_ba),
        enabled_(options.global_ba_enabled),
        max_keyframes_(static_cast<size_t>(options.global_ba_max_keyframes)),
        lag_frames_(options.executor.global_ba_lag_frames) {}

  /// Requests a job. Called after a loop was corrected.
  void request() { requested_ = true; }

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& context) const;
  [[nodiscard]] Problem make_problem(const JobContext& context);
  [[nodiscard]] static Solution solve(const Problem& problem);
  [[nodiscard]] static std::optional<AppliedSolution> apply(Map& map, const Solution& update);
  void on_stale(const Solution& /*update*/) {}

 private:
  BundleOptions options_;
  bool enabled_;
  size_t max_keyframes_;
  int lag_frames_;
  bool requested_ = false;
  size_t min_keyframes_ = 0;  // map size required for the next job
};

}  // namespace kinloop
