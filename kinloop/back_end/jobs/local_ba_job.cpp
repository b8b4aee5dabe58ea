#include "kinloop/back_end/jobs/adjustment_jobs.hpp"

namespace kinloop {

bool LocalBaJob::is_due(const JobContext& context) const {
  return options_.local_ba_enabled && context.new_keyframe.valid() &&
         !context.map.keyframe(context.new_keyframe).begins_component;
}

LocalBaJob::Problem LocalBaJob::make_problem(const JobContext& context) const {
  return {make_local_ba_problem(context.map, context.new_keyframe, context.sensor, options_),
          options_.local_ba};
}

MapUpdate LocalBaJob::solve(const Problem& problem) {
  return run_bundle_adjustment(problem.problem, problem.options);
}

std::optional<AppliedSolution> LocalBaJob::apply(Map& map, const MapUpdate& update) {
  if (!map.apply(update)) return std::nullopt;
  return AppliedSolution{};
}

}  // namespace kinloop
