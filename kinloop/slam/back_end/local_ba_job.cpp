#include "kinloop/slam/back_end/local_ba_job.hpp"

namespace kinloop {

bool LocalBaJob::is_due(const JobContext& context) const {
  return options_.local_ba_enabled && context.new_keyframe.valid() &&
         !context.map.keyframe(context.new_keyframe).begins_component;
}

/// Around the new keyframe; where a stale job is repeated, around the same one as before.
LocalBaJob::Problem LocalBaJob::make_problem(const JobContext& context) {
  if (is_due(context)) center_ = context.new_keyframe;
  return {make_local_ba_problem(context.map, center_, camera_, options_), options_.local_ba};
}

MapUpdate LocalBaJob::solve(const Problem& problem) {
  return run_bundle_adjustment(problem.problem, problem.options);
}

std::optional<AppliedSolution> LocalBaJob::apply(Map& map, const MapUpdate& update) {
  if (!map.apply(update)) return std::nullopt;
  return AppliedSolution{};
}

}  // namespace kinloop
