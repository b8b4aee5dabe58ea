#pragma once
// Verifies loop candidates geometrically; accepted ones become edges of the map.

#include "kinloop/back_end/job_context.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

class LoopVerificationJob {
 public:
  static constexpr const char* kName = "loop verification";
  static constexpr bool kMovesWholeMap = false;
  struct Problem {
    std::vector<LoopCandidates> candidates;
    Sensor sensor;
    LoopOptions loop;
    TrackingOptions tracking;
  };
  using Solution = std::vector<VerifiedLoop>;

  explicit LoopVerificationJob(const BackEndOptions& options)
      : loop_(options.loop),
        tracking_(options.tracking),
        lag_frames_(options.executor.loop_verification_lag_frames) {}

  /// Adds candidates to the next job.
  void add(LoopCandidates candidates);

  [[nodiscard]] int lag_frames() const { return lag_frames_; }
  [[nodiscard]] bool is_due(const JobContext& context) const;
  [[nodiscard]] Problem make_problem(const JobContext& context);
  [[nodiscard]] static Solution solve(const Problem& problem);
  /// Never stale: a loop is relative to keyframes, so it stays valid when they move.
  [[nodiscard]] std::optional<AppliedSolution> apply(Map& map, const Solution& loops) const;
  void on_stale(const Solution& /*loops*/) {}

 private:
  LoopOptions loop_;
  TrackingOptions tracking_;
  int lag_frames_;
  std::vector<LoopCandidates> waiting_;
};

}  // namespace kinloop
