#include "kinloop/back_end/jobs/adjustment_jobs.hpp"

namespace kinloop {

bool GlobalBaJob::is_due(const JobContext& context) const {
  const size_t keyframes = context.map.keyframes().size();
  return requested_ && enabled_ && keyframes >= min_keyframes_ && keyframes <= max_keyframes_;
}

GlobalBaJob::Problem GlobalBaJob::make_problem(const JobContext& context) {
  requested_ = false;
  // Waiting for the map to grow by a fixed factor keeps the cost per keyframe constant for any map size.
  constexpr double kGrowth = 1.25;
  min_keyframes_ = static_cast<size_t>(kGrowth * static_cast<double>(context.map.keyframes().size()));
  return {make_global_ba_problem(context.map, context.sensor), options_};
}

MapUpdate GlobalBaJob::solve(const Problem& problem) {
  return run_bundle_adjustment(problem.problem, problem.options);
}

std::optional<AppliedSolution> GlobalBaJob::apply(Map& map, const MapUpdate& update) {
  if (!map.apply(update)) return std::nullopt;
  map.advance_epoch();
  return AppliedSolution{};
}

}  // namespace kinloop
