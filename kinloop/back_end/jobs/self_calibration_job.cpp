#include "kinloop/back_end/jobs/self_calibration_job.hpp"

#include "kinloop/map/frame_velocities.hpp"

namespace kinloop {

bool SelfCalibrationJob::is_due(const JobContext& context) const {
  const size_t keyframes = context.map.keyframes().size();
  return enabled_ && context.new_keyframe.valid() && keyframes >= min_keyframes_ &&
         keyframes <= max_keyframes_;
}

SelfCalibrationJob::Problem SelfCalibrationJob::make_problem(const JobContext& context) const {
  auto problem = make_self_calibration_problem(context.map, context.sensor,
                                               keyframe_velocities(context.log, context.map));
  problem.bundle.prior = prior_;
  return {std::move(problem), options_};
}

SelfCalibrationResult SelfCalibrationJob::solve(const Problem& problem) {
  return run_self_calibration(problem.problem, problem.options);
}

std::optional<AppliedSolution> SelfCalibrationJob::apply(Map& map, const SelfCalibrationResult& result) {
  if (!map.apply(result.update)) return std::nullopt;
  map.advance_epoch();
  min_keyframes_ *= 2;
  AppliedSolution applied;
  applied.sensor = result.sensor;
  return applied;
}

}  // namespace kinloop
