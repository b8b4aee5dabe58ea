#include <algorithm>
#include <utility>

#include "kinloop/back_end/jobs/loop_jobs.hpp"

namespace kinloop {
namespace {

bool is_edge(const LoopEnds& ends, const Map& map) {
  const auto& loops = map.loop_closures();
  return std::any_of(loops.begin(), loops.end(),
                     [&](const LoopClosure& loop) { return loop.ends() == ends; });
}

}  // namespace

void LoopCorrectionJob::add(const std::vector<LoopMerges>& merges) {
  merges_.insert(merges_.end(), merges.begin(), merges.end());
  loops_waiting_ = true;
}

bool LoopCorrectionJob::is_due(const JobContext& /*context*/) const {
  return loops_waiting_;
}

LoopCorrectionJob::Problem LoopCorrectionJob::make_problem(const JobContext& context) {
  loops_waiting_ = false;
  // Some may have been taken back meanwhile.
  std::erase_if(merges_, [&](const LoopMerges& merges) { return !is_edge(merges.loop, context.map); });
  odometry_.observe(context.map, options_);
  return {make_loop_correction_problem(context.map, std::exchange(merges_, {}), odometry_, options_),
          options_};
}

LoopCorrection LoopCorrectionJob::solve(const Problem& problem) {
  return correct_loop(problem.problem, problem.options);
}

std::optional<AppliedSolution> LoopCorrectionJob::apply(Map& map, const LoopCorrection& correction) {
  if (correction.update.epoch != map.epoch()) return std::nullopt;
  AppliedSolution applied;
  applied.loops_corrected = true;
  if (!correction.withdrawn.empty()) {
    applied.T_world_keyframe_before = map.withdraw_loops(correction.withdrawn, LoopReason::kDoesNotFit);
  }
  map.apply(correction.update);
  map.mark_corrected(correction.loops);
  map.advance_epoch();
  return applied;
}

void LoopCorrectionJob::on_stale(const LoopCorrection& correction) {
  merges_.insert(merges_.end(), correction.merges.begin(), correction.merges.end());
}

}  // namespace kinloop
