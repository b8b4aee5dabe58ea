#include <utility>

#include "kinloop/back_end/jobs/adjustment_jobs.hpp"
#include "kinloop/map/frames/frame_velocities.hpp"
#include "kinloop/tracking/motion/motion_compensation.hpp"

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
  std::vector<std::shared_ptr<const Features>> features;
  for (const Keyframe& keyframe : context.map.keyframes()) features.push_back(keyframe.features);
  return {std::move(problem), options_, std::move(features)};
}

SelfCalibrationJob::Solution SelfCalibrationJob::solve(const Problem& problem) {
  Solution solution{run_self_calibration(problem.problem, problem.options), problem.features};
  const auto& velocities = problem.problem.bundle.velocities;
  for (size_t i = 0; i < velocities.size(); ++i) {
    solution.features[i] = std::make_shared<const Features>(
        deskew_features(*problem.features[i], solution.result.sensor.sensor, velocities[i]));
  }
  return solution;
}

std::optional<AppliedSolution> SelfCalibrationJob::apply(Map& map, const Solution& solution) {
  if (!map.apply(solution.result.update)) return std::nullopt;
  map.advance_epoch();
  min_keyframes_ *= 2;
  for (uint32_t i = 0; i < solution.features.size(); ++i)
    map.set_features(KeyframeId{i}, solution.features[i]);
  AppliedSolution applied;
  applied.sensor = {solution.result.sensor, solution.features.size()};
  return applied;
}

}  // namespace kinloop
