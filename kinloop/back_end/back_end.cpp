#include "kinloop/back_end/back_end.hpp"

#include <utility>

namespace kinloop {

BackEnd::BackEnd(Map& map, const Sensor& nominal, const BackEndOptions& options)
    : map_(map),
      verification_{LoopVerificationJob(options)},
      correction_{LoopCorrectionJob(options)},
      global_ba_{GlobalBaJob(options)},
      local_ba_{LocalBaJob(options)},
      self_calibration_{SelfCalibrationJob(nominal, options)},
      executor_(make_executor(options.executor)) {}

void BackEnd::submit(FrameId now, const JobContext& context) {
  submit(verification_, now, context);
  submit(correction_, now, context);  // before jobs that wait for it
  submit(global_ba_, now, context);
  submit(local_ba_, now, context);
  submit(self_calibration_, now, context);
}

AppliedResults BackEnd::apply_due(FrameId now) {
  complete(executor_->collect(now));
  if (std::exchange(loops_corrected_, false)) global_ba_.kind.request();
  return std::exchange(results_, {});
}

AppliedResults BackEnd::apply_remaining(const JobContext& context) {
  complete(executor_->drain());
  solve_now(verification_, context);
  solve_now(correction_, context);
  loops_corrected_ = false;  // no global bundle adjustment needed: the run ends or a map is added next
  return std::exchange(results_, {});
}

template <class Kind>
void BackEnd::submit(Slot<Kind>& slot, FrameId now, const JobContext& context) {
  if (executor_->busy(Kind::kName)) return;
  if (Kind::kMovesWholeMap && global_correction_in_flight()) return;
  if (!slot.stale && !slot.kind.is_due(context)) return;
  slot.stale = false;
  auto work = [this, &slot, problem = slot.kind.make_problem(context)]() -> Completion {
    return [this, &slot, solution = Kind::solve(problem)] { apply(slot, solution); };
  };
  executor_->submit(now, {Kind::kName, slot.kind.lag_frames(), std::move(work)});
}

template <class Kind>
void BackEnd::solve_now(Slot<Kind>& slot, const JobContext& context) {
  if (!slot.stale && !slot.kind.is_due(context)) return;
  slot.stale = false;
  apply(slot, Kind::solve(slot.kind.make_problem(context)));
}

template <class Kind>
void BackEnd::apply(Slot<Kind>& slot, typename Kind::Solution solution) {
  auto applied = slot.kind.apply(map_, solution);
  if (!applied) {
    slot.kind.on_stale(std::move(solution));
    slot.stale = Kind::kMovesWholeMap;
    results_.stale.emplace_back(Kind::kName);
    return;
  }
  results_.map_changed |= applied->map_changed;
  loops_corrected_ |= applied->loops_corrected;
  if (applied->loops_added) correction_.kind.add(applied->merges);
  if (applied->sensor) results_.sensor = std::move(applied->sensor);
}

void BackEnd::complete(const std::vector<FinishedJob>& jobs) {
  for (const FinishedJob& job : jobs) {
    results_.elapsed.emplace_back(job.kind, job.elapsed);
    job.complete();
  }
}

/// Whether a job that moves the whole map is in flight.
bool BackEnd::global_correction_in_flight() const {
  return executor_->busy(LoopCorrectionJob::kName) || executor_->busy(GlobalBaJob::kName);
}

}  // namespace kinloop
