#include "kinloop/back_end/jobs/loop_correction_job.hpp"

#include <utility>

namespace kinloop {

void LoopCorrectionJob::add(const LandmarkMerges& merges) {
  merges_.insert(merges_.end(), merges.begin(), merges.end());
  loops_waiting_ = true;
}

bool LoopCorrectionJob::is_due(const JobContext& /*context*/) const {
  return loops_waiting_;
}

LoopCorrectionJob::Problem LoopCorrectionJob::make_problem(const JobContext& context) {
  loops_waiting_ = false;
  loops_in_problem_ = context.map.loop_closures().size();
  return {make_loop_correction_problem(context.map, std::exchange(merges_, {}), options_, corrected_loops_),
          options_};
}

MapUpdate LoopCorrectionJob::solve(const Problem& problem) {
  return correct_loop(problem.problem, problem.options);
}

std::optional<AppliedSolution> LoopCorrectionJob::apply(Map& map, const MapUpdate& update) {
  if (!map.apply(update)) return std::nullopt;
  corrected_loops_ = loops_in_problem_;
  map.advance_epoch();
  AppliedSolution applied;
  applied.loops_corrected = true;
  return applied;
}

void LoopCorrectionJob::on_stale(const MapUpdate& update) {
  merges_.insert(merges_.end(), update.merges.begin(), update.merges.end());
}

}  // namespace kinloop
