#include "session/plan/run_options.hpp"

#include <algorithm>
#include <utility>

#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

/// Gives all dense results the limits of the dense map.
RunOptions with_dense_limits(RunOptions options, const DepthLimits& limits) {
  options.dense.limits = options.mesh.limits = options.occupancy.limits = options.viewer.limits = limits;
  return options;
}

/// Whether an assignment "key=value" sets this option.
bool assigns(std::span<const std::string> assignments, std::string_view key) {
  return std::any_of(assignments.begin(), assignments.end(), [&](const std::string& assignment) {
    return assignment.starts_with(key) && assignment.substr(key.size()).starts_with('=');
  });
}

/// The limits for a sensor that is known, and for a near scene.
DepthLimits suited_limits(const InputTraits& input, DepthLimits limits) {
  if (input.sensor.origin != SensorOrigin::kAssumed) limits.min_depth_m = input.sensor.min_depth_m;
  if (!input.near_minimum_m) return limits;
  const double usual_m = std::exchange(limits.min_depth_m, *input.near_minimum_m);
  log::info("{}: most depth is nearer than {} m: mapped from {:.2f} m on (else --set dense.min_depth_m={})",
            input.name, usual_m, limits.min_depth_m, usual_m);
  return limits;
}

}  // namespace

RunOptions run_options_with(RunOptions options, std::span<const std::string> assignments) {
  options = with_assignments(options, assignments);
  const DepthLimits limits = options.dense.limits;
  return with_dense_limits(std::move(options), limits);
}

RunOptions with_memory_limit(RunOptions options, int memory_mib) {
  constexpr int kImageRatio = 4;  // images are not read before the end
  options.dense.image_memory_mib = std::min(options.dense.image_memory_mib, memory_mib / kImageRatio);
  options.dense.fusion_memory_mib = std::min(options.dense.fusion_memory_mib, memory_mib);
  options.slam.keyframe_memory_mib = memory_mib - options.dense.image_memory_mib;
  return options;
}

const std::vector<WorkLevel>& work_levels() {
  static const std::vector<WorkLevel> levels{
      {24, {}},
      {20, {"dense.surfels_at_end=true"}},
      {18, {"dense.surfels_at_end=true", "features.count=800", "local_map.max_landmarks=2000"}},
      {15,
       {"dense.surfels_at_end=true", "features.count=600", "local_map.max_landmarks=1200",
        "tracking.keyframe.max_relative_translation=0.11", "tracking.keyframe.max_rotation_rad=0.27",
        "mapping.triangulation_keyframes=2", "mapping.local_ba_keyframes=8"}}};
  return levels;
}

const WorkLevel& work_level(double percent) {
  const auto& levels = work_levels();
  const auto affordable = std::find_if(levels.begin(), levels.end(),
                                       [=](const WorkLevel& level) { return level.percent <= percent; });
  return affordable != levels.end() ? *affordable : levels.back();
}

RunOptions within_budget(const RunOptions& options, double percent) {
  const WorkLevel& level = work_level(percent);
  if (level.percent > percent)
    log::warn("--budget {}: the least work takes about {} % of a core at 30 Hz", percent, level.percent);
  return run_options_with(options, level.assignments);
}

RunOptions within_range(RunOptions options, const DepthSensor& sensor) {
  const DepthLimits limits = within_range(options.dense.limits, sensor);
  return with_dense_limits(std::move(options), limits);
}

RunOptions suited_to(const InputTraits& input, RunOptions options, std::span<const std::string> assignments) {
  if (input.live && !assigns(assignments, "executor.mode")) options.slam.executor.mode = ExecutorMode::kLive;
  if (!assigns(assignments, "dense.min_depth_m"))
    options.dense.limits = suited_limits(input, options.dense.limits);
  return within_range(std::move(options), input.sensor);
}

}  // namespace kinloop
