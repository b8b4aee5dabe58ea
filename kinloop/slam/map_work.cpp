#include "kinloop/slam/map_work.hpp"

#include "kinloop/loop/correct_loop.hpp"
#include "kinloop/mapping/local_adjustment.hpp"

namespace kinloop {
namespace {

std::vector<LoopAnswer> answers_to(const std::vector<LoopQuestion>& questions, const PinholeCamera& camera,
                                   const SlamOptions& options) {
  std::vector<LoopAnswer> answers;
  for (const LoopQuestion& question : questions) {
    auto answer = verify_loop(question, camera, options.loop, options.tracking);
    if (answer) answers.push_back(std::move(*answer));
  }
  return answers;
}

}  // namespace

MapWork::MapWork(const RgbdCamera& camera, const SlamOptions& options)
    : camera_(camera),
      options_(options),
      executor_(make_executor(options.executor)),
      keyframes_to_calibrate_(static_cast<size_t>(options.self_calibration.first_keyframes)) {}

void MapWork::submit(const Map& map, const FrameLog& log, const SensorEstimate& sensor, KeyframeId newest,
                     FrameId now) {
  submit_verification(now);
  submit_bending(map, now);
  submit_local(map, newest, now);
  submit_calibration(map, log, sensor, now);
}

AppliedWork MapWork::apply(Map& map, const std::vector<FinishedJob>& jobs) {
  AppliedWork applied;
  for (const FinishedJob& job : jobs) {
    applied.spent.emplace_back(job.kind, job.spent);
    if (job.kind == JobKind::kLoopVerification) {
      take_loops(map, job.result.loops);
      applied.map_changed |= !job.result.loops.empty();
      continue;
    }
    if (!map.apply(job.result.update)) {
      if (job.kind == JobKind::kLoopCorrection) return_loops(job.result.update);
      continue;
    }
    applied.map_changed = true;
    if (job.kind != JobKind::kLocalAdjustment) map.raise_epoch();
    if (job.kind == JobKind::kLoopCorrection) full_adjustment_pending_ = true;
    if (job.result.sensor) applied.sensor = job.result.sensor;
  }
  return applied;
}

AppliedWork MapWork::apply_due(Map& map, FrameId now) {
  AppliedWork applied = apply(map, executor_->collect(now));
  submit_verification(now);
  submit_bending(map, now);
  return applied;
}

AppliedWork MapWork::apply_rest(Map& map) {
  AppliedWork applied = apply(map, executor_->drain());
  take_loops(map, answers_to(std::exchange(questions_, {}), camera_.color, options_));
  if (loop_pending_) {
    map.apply(correct_loop(take_loop_problem(map), options_.loop));
    map.raise_epoch();
    applied.map_changed = true;
  }
  return applied;
}

void MapWork::take_loops(Map& map, const std::vector<LoopAnswer>& answers) {
  for (const LoopAnswer& answer : answers) {
    const LoopClosure closure = closure_of(map, answer, options_.loop);
    map.add_loop_edge(closure.edge);
    merges_.insert(merges_.end(), closure.merges.begin(), closure.merges.end());
    loop_pending_ = true;
  }
}

/// Whether work that moves the whole map is in flight.
bool MapWork::bending() const {
  return executor_->busy(JobKind::kLoopCorrection) || executor_->busy(JobKind::kFullAdjustment);
}

/// The map was changed under a correction: its loops are corrected with the next.
void MapWork::return_loops(const MapUpdate& stale) {
  merges_.insert(merges_.end(), stale.merges.begin(), stale.merges.end());
  loop_pending_ = true;
}

LoopProblem MapWork::take_loop_problem(const Map& map) {
  loop_pending_ = false;
  return loop_problem(map, std::exchange(merges_, {}), options_.loop);
}

void MapWork::submit_verification(FrameId now) {
  if (questions_.empty() || executor_->busy(JobKind::kLoopVerification)) return;
  executor_->submit(JobKind::kLoopVerification, now,
                    [questions = std::exchange(questions_, {}), camera = camera_.color, options = options_] {
                      return answers_to(questions, camera, options);
                    });
}

void MapWork::submit_bending(const Map& map, FrameId now) {
  if (bending()) return;
  if (loop_pending_) {
    executor_->submit(JobKind::kLoopCorrection, now,
                      [problem = take_loop_problem(map), options = options_.loop] {
                        return correct_loop(problem, options);
                      });
  } else if (full_adjustment_pending_ && options_.full_adjustment &&
             map.keyframes().size() >= keyframes_to_adjust_) {
    executor_->submit(JobKind::kFullAdjustment, now,
                      [problem = full_problem(map, camera_.color), options = options_.full] {
                        return adjust(problem, options);
                      });
    full_adjustment_pending_ = false;
    // Waiting for the map to grow by a share of itself keeps the cost per keyframe the same, however large it
    // gets.
    constexpr double kGrowth = 1.25;
    keyframes_to_adjust_ = static_cast<size_t>(kGrowth * static_cast<double>(map.keyframes().size()));
  }
}

void MapWork::submit_local(const Map& map, KeyframeId newest, FrameId now) {
  if (!options_.mapping.local_adjustment || map.keyframe(newest).begins_component ||
      executor_->busy(JobKind::kLocalAdjustment)) {
    return;
  }
  executor_->submit(JobKind::kLocalAdjustment, now,
                    [problem = local_problem(map, newest, camera_.color, options_.mapping),
                     options = options_.mapping.bundle] { return adjust(problem, options); });
}

void MapWork::submit_calibration(const Map& map, const FrameLog& log, const SensorEstimate& sensor,
                                 FrameId now) {
  const SelfCalibrationOptions& calibration = options_.self_calibration;
  if (!calibration.enabled || bending() || map.keyframes().size() < keyframes_to_calibrate_ ||
      executor_->busy(JobKind::kSelfCalibration)) {
    return;
  }
  executor_->submit(JobKind::kSelfCalibration, now,
                    [problem = calibration_problem(map, camera_, keyframe_velocities(log, map), sensor.value),
                     expected = expected_time_sigmas(calibration), calibration, options = options_.full] {
                      return adjust_with_sensor(problem, expected, calibration, options);
                    });
  keyframes_to_calibrate_ *= 2;
}

}  // namespace kinloop
