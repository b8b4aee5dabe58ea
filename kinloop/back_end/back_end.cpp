#include "kinloop/back_end/back_end.hpp"

#include <utility>

namespace kinloop {

BackEnd::BackEnd(Map& map, const SensorEstimate& nominal, const BackEndOptions& options, IsAliased is_aliased)
    : map_(map),
      slots_{{LoopVerificationJob(options)},
             {LoopDecisionJob(options, std::move(is_aliased))},
             {LoopCorrectionJob(options)},
             {JoinCheckJob(options)},
             {GlobalBaJob(options)},
             {LocalBaJob(options)},
             {SelfCalibrationJob(nominal, options)}},
      executor_(make_executor(options.executor)) {}

void BackEnd::submit(FrameId now, const JobContext& context) {
  std::apply([&](auto&... slot) { (submit(slot, now, context), ...); }, slots_);
}

AppliedResults BackEnd::apply_due(FrameId now) {
  complete(executor_->collect(now));
  if (std::exchange(loops_corrected_, false)) job<GlobalBaJob>().request();
  return std::exchange(results_, {});
}

AppliedResults BackEnd::apply_remaining(const JobContext& context) {
  solve_remaining(context);
  loops_corrected_ = false;  // no global bundle adjustment needed: the run ends or a map is added next
  return std::exchange(results_, {});
}

AppliedResults BackEnd::apply_last(const JobContext& context) {
  solve_remaining(context);
  take(job<LoopDecisionJob>().finish(map_));
  solve_remaining(context);
  take(job<JoinCheckJob>().finish(map_));
  return apply_remaining(context);
}

/// Finishes the jobs in flight and those that are due because of loops.
void BackEnd::solve_remaining(const JobContext& context) {
  complete(executor_->drain());
  solve_now<LoopVerificationJob>(context);
  while (job<LoopDecisionJob>().is_due(context)) solve_now<LoopDecisionJob>(context);
  solve_now<LoopCorrectionJob>(context);
  solve_now<JoinCheckJob>(context);
}

template <class Kind>
void BackEnd::submit(Slot<Kind>& slot, FrameId now, const JobContext& context) {
  if (executor_->busy(Kind::kName)) return;
  if (Kind::kMovesWholeMap && global_correction_in_flight()) return;
  if (!slot.stale && !slot.kind.is_due(context)) return;
  slot.stale = false;
  auto work = [this, &slot, problem = slot.kind.make_problem(context)]() -> Completion {
    return [this, &slot, solution = Kind::solve(problem)]() mutable { apply(slot, std::move(solution)); };
  };
  executor_->submit(now, {Kind::kName, slot.kind.lag_frames(), std::move(work)});
}

template <class Kind>
void BackEnd::solve_now(const JobContext& context) {
  auto& slot = std::get<Slot<Kind>>(slots_);
  if (!slot.stale && !slot.kind.is_due(context)) return;
  slot.stale = false;
  apply(slot, Kind::solve(slot.kind.make_problem(context)));
}

template <class Kind>
void BackEnd::apply(Slot<Kind>& slot, typename Kind::Solution&& solution) {
  auto applied = slot.kind.apply(map_, solution);
  if (!applied) {
    slot.kind.on_stale(std::move(solution));
    slot.stale = Kind::kMovesWholeMap;
    results_.stale.emplace_back(Kind::kName);
    return;
  }
  take(*std::move(applied));
}

void BackEnd::take(AppliedSolution applied) {
  if (!applied.verified.empty()) take(job<LoopDecisionJob>().add(map_, applied.verified));
  results_.map_changed |= applied.map_changed;
  loops_corrected_ |= applied.loops_corrected;
  if (!applied.contradicted_joins.empty())
    job<LoopDecisionJob>().record_contradicted(applied.contradicted_joins);
  if (applied.loops_added) job<LoopCorrectionJob>().add(applied.merges);
  if (applied.sensor) results_.sensor = std::move(applied.sensor);
  if (results_.T_world_keyframe_before.empty())
    results_.T_world_keyframe_before = std::move(applied.T_world_keyframe_before);
}

void BackEnd::complete(const std::vector<FinishedJob>& jobs) {
  for (const FinishedJob& job : jobs) {
    results_.elapsed.emplace_back(job.kind, job.elapsed);
    job.complete();
  }
}

/// Whether a job that moves the whole map is in flight.
bool BackEnd::global_correction_in_flight() const {
  const auto in_flight = [this]<class Kind>(const Slot<Kind>& /*slot*/) {
    return Kind::kMovesWholeMap && executor_->busy(Kind::kName);
  };
  return std::apply([&](const auto&... slot) { return (in_flight(slot) || ...); }, slots_);
}

}  // namespace kinloop
