#include "session/plan/run_options.hpp"

#include <algorithm>
#include <utility>

namespace kinloop {
namespace {

/// Gives all dense results the limits of the dense map.
RunOptions with_dense_limits(RunOptions options, const DepthLimits& limits) {
  options.dense.limits = options.mesh.limits = options.occupancy.limits = options.viewer.limits = limits;
  return options;
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

bool assigns(std::span<const std::string> assignments, std::string_view key) {
  return std::any_of(assignments.begin(), assignments.end(), [&](const std::string& assignment) {
    return assignment.starts_with(key) && assignment.substr(key.size()).starts_with('=');
  });
}

RunOptions with_minimum_depth(RunOptions options, double min_depth_m) {
  DepthLimits limits = options.dense.limits;
  limits.min_depth_m = min_depth_m;
  return with_dense_limits(std::move(options), limits);
}

RunOptions with_sensor_range(RunOptions options, const DepthSensor& sensor,
                             std::span<const std::string> assignments) {
  if (sensor.origin != SensorOrigin::kAssumed && !assigns(assignments, "dense.min_depth_m"))
    options = with_minimum_depth(std::move(options), sensor.min_depth_m);
  return within_range(std::move(options), sensor);
}

RunOptions within_range(RunOptions options, const DepthSensor& sensor) {
  const DepthLimits limits = within_range(options.dense.limits, sensor);
  return with_dense_limits(std::move(options), limits);
}

}  // namespace kinloop
