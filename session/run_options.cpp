#include "session/run_options.hpp"

#include <algorithm>

namespace kinloop {

RunOptions run_options_with(RunOptions options, std::span<const std::string> assignments) {
  options = with_assignments(options, assignments);
  options.mesh.limits = options.occupancy.limits = options.viewer.limits = options.dense.limits;
  return options;
}

RunOptions with_memory_limit(RunOptions options, int memory_mib) {
  constexpr int kImageRatio = 4;  // images are not read before the end
  options.dense.image_memory_mib = std::min(options.dense.image_memory_mib, memory_mib / kImageRatio);
  options.dense.fusion_memory_mib = std::min(options.dense.fusion_memory_mib, memory_mib);
  options.slam.keyframe_memory_mib = memory_mib - options.dense.image_memory_mib;
  return options;
}

RunOptions within_range(RunOptions options, const DepthSensor& sensor) {
  options.dense.limits = within_range(options.dense.limits, sensor);
  options.mesh.limits = options.occupancy.limits = options.viewer.limits = options.dense.limits;
  return options;
}

}  // namespace kinloop
