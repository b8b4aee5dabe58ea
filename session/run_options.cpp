#include "session/run_options.hpp"

#include <algorithm>

namespace kinloop {

OptionHistory RunOptions::history() {
  OptionHistory history = SlamOptions::history();
  const std::vector<RenamedOption> renamed = {
      {"dense.patch_memory_mib", "dense.surfel_memory_mib"},
      {"dense.even_exposure", "dense.compensate_exposure"},
      {"dense.max_slope_deg", "dense.max_incidence_deg"},
      {"dense.min_m", "dense.min_depth_m"},
      {"dense.max_m", "dense.max_depth_m"},
      {"mesh.min_piece", "mesh.min_component_triangles"},
      {"occupancy.grid_low_m", "occupancy.grid_min_height_m"},
      {"occupancy.grid_high_m", "occupancy.grid_max_height_m"},
      {"viewer.images_hz", "viewer.image_rate_hz"},
  };
  history.renamed.insert(history.renamed.end(), renamed.begin(), renamed.end());
  for (const std::string map : {"mesh.", "occupancy."}) {
    for (const char* name : {"max_incidence_deg", "min_depth_m", "max_depth_m"})
      history.renamed.push_back({map + name, std::string("dense.") + name});
    history.renamed.push_back({map + "max_slope_deg", "dense.max_incidence_deg"});
    history.renamed.push_back({map + "min_m", "dense.min_depth_m"});
    history.renamed.push_back({map + "max_m", "dense.max_depth_m"});
  }
  for (const char* name : {"viewer.max_m", "viewer.max_depth_m", "viewer.min_shared",
                           "viewer.min_shared_landmarks", "viewer.max_neighbors"})
    history.removed.emplace_back(name);
  return history;
}

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
