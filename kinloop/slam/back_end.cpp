#include "kinloop/slam/back_end.hpp"

#include "kinloop/loop/correct_loop.hpp"
#include "kinloop/mapping/bundle_adjustment.hpp"

namespace kinloop {
namespace {

std::vector<VerifiedLoop> verify_loops(const std::vector<LoopCandidates>& loop_candidates,
                                       const PinholeCamera& camera, const SlamOptions& options) {
  std::vector<VerifiedLoop> loops;
  for (const LoopCandidates& candidates : loop_candidates) {
    auto loop = verify_loop(candidates, camera, options.loop, options.tracking);
    if (loop) loops.push_back(std::move(*loop));
  }
  return loops;
}

}  // namespace

BackEnd::BackEnd(const RgbdCamera& camera, const SlamOptions& options)
    : camera_(camera),
      options_(options),
      executor_(make_executor(options.executor)),
      min_keyframes_for_calibration_(static_cast<size_t>(options.self_calibration.min_keyframes)) {}

void BackEnd::submit(const Map& map, const FrameLog& log, const SensorEstimate& sensor, KeyframeId newest,
                     FrameId now) {
  submit_verification(now);
  submit_global_correction(map, now);
  submit_local_ba(map, newest, now);
  submit_self_calibration(map, log, sensor, now);
}

AppliedResults BackEnd::apply(Map& map, const std::vector<FinishedJob>& jobs) {
  AppliedResults applied;
  for (const FinishedJob& job : jobs) {
    applied.elapsed.emplace_back(job.kind, job.elapsed);
    if (job.kind == JobKind::kLoopVerification) {
      add_verified_loops(map, job.result.loops);
      applied.map_changed |= !job.result.loops.empty();
      continue;
    }
    if (!map.apply(job.result.update)) {
      if (job.kind == JobKind::kLoopCorrection) requeue_loops(job.result.update);
      continue;
    }
    applied.map_changed = true;
    if (job.kind != JobKind::kLocalBundleAdjustment) map.advance_epoch();
    if (job.kind == JobKind::kLoopCorrection) global_ba_pending_ = true;
    if (job.result.sensor) applied.sensor = job.result.sensor;
  }
  return applied;
}

AppliedResults BackEnd::apply_due(Map& map, FrameId now) {
  AppliedResults applied = apply(map, executor_->collect(now));
  submit_verification(now);
  submit_global_correction(map, now);
  return applied;
}

AppliedResults BackEnd::apply_remaining(Map& map) {
  AppliedResults applied = apply(map, executor_->drain());
  add_verified_loops(map, verify_loops(std::exchange(loop_candidates_, {}), camera_.color, options_));
  if (loop_pending_) {
    map.apply(correct_loop(make_pending_loop_problem(map), options_.loop));
    map.advance_epoch();
    applied.map_changed = true;
  }
  return applied;
}

void BackEnd::add_verified_loops(Map& map, const std::vector<VerifiedLoop>& loops) {
  for (const VerifiedLoop& loop : loops) {
    const LoopConstraint constraint = make_loop_constraint(map, loop, options_.loop);
    map.add_loop_edge(constraint.edge);
    merges_.insert(merges_.end(), constraint.merges.begin(), constraint.merges.end());
    loop_pending_ = true;
  }
}

/// Whether work that moves the whole map is in flight.
bool BackEnd::global_correction_in_flight() const {
  return executor_->busy(JobKind::kLoopCorrection) || executor_->busy(JobKind::kGlobalBundleAdjustment);
}

/// The map was changed under a correction: its loops are corrected with the next.
void BackEnd::requeue_loops(const MapUpdate& stale) {
  merges_.insert(merges_.end(), stale.merges.begin(), stale.merges.end());
  loop_pending_ = true;
}

LoopProblem BackEnd::make_pending_loop_problem(const Map& map) {
  loop_pending_ = false;
  return make_loop_problem(map, std::exchange(merges_, {}), options_.loop);
}

void BackEnd::submit_verification(FrameId now) {
  if (loop_candidates_.empty() || executor_->busy(JobKind::kLoopVerification)) return;
  executor_->submit(JobKind::kLoopVerification, now,
                    [loop_candidates = std::exchange(loop_candidates_, {}), camera = camera_.color,
                     options = options_] { return verify_loops(loop_candidates, camera, options); });
}

void BackEnd::submit_global_correction(const Map& map, FrameId now) {
  if (global_correction_in_flight()) return;
  if (loop_pending_) {
    executor_->submit(JobKind::kLoopCorrection, now,
                      [problem = make_pending_loop_problem(map), options = options_.loop] {
                        return correct_loop(problem, options);
                      });
  } else if (global_ba_pending_ && options_.global_ba_enabled &&
             map.keyframes().size() >= min_keyframes_for_global_ba_) {
    executor_->submit(JobKind::kGlobalBundleAdjustment, now,
                      [problem = make_global_ba_problem(map, camera_.color), options = options_.global_ba] {
                        return run_bundle_adjustment(problem, options);
                      });
    global_ba_pending_ = false;
    // Waiting for the map to grow by a share of itself keeps the cost per keyframe the same, however large it
    // gets.
    constexpr double kGrowth = 1.25;
    min_keyframes_for_global_ba_ = static_cast<size_t>(kGrowth * static_cast<double>(map.keyframes().size()));
  }
}

void BackEnd::submit_local_ba(const Map& map, KeyframeId newest, FrameId now) {
  if (!options_.mapping.local_ba_enabled || map.keyframe(newest).begins_component ||
      executor_->busy(JobKind::kLocalBundleAdjustment)) {
    return;
  }
  executor_->submit(
      JobKind::kLocalBundleAdjustment, now,
      [problem = make_local_ba_problem(map, newest, camera_.color, options_.mapping),
       options = options_.mapping.local_ba] { return run_bundle_adjustment(problem, options); });
}

void BackEnd::submit_self_calibration(const Map& map, const FrameLog& log, const SensorEstimate& sensor,
                                      FrameId now) {
  const SelfCalibrationOptions& calibration = options_.self_calibration;
  if (!calibration.enabled || global_correction_in_flight() ||
      map.keyframes().size() < min_keyframes_for_calibration_ || executor_->busy(JobKind::kSelfCalibration)) {
    return;
  }
  executor_->submit(
      JobKind::kSelfCalibration, now,
      [problem = make_self_calibration_problem(map, camera_, keyframe_velocities(log, map), sensor.value),
       expected = prior_time_sigmas(calibration), calibration, options = options_.global_ba] {
        return run_self_calibration(problem, expected, calibration, options);
      });
  min_keyframes_for_calibration_ *= 2;
}

}  // namespace kinloop
