#include "apps/version.hpp"

#include <fmt/format.h>

#include "kinloop/compare/detectors.hpp"
#include "kinloop/dense/occupancy.hpp"
#include "kinloop/dense/tsdf_volume.hpp"
#include "kinloop/features/surf.hpp"
#include "kinloop/optimize/pose_graph.hpp"

namespace kinloop {

std::string program_name() {
  return "kinloop " KINLOOP_VERSION;
}

std::string version_text() {
  const char* g2o = pose_graph_solver_available("g2o") ? "yes" : "no (not found when built)";
  const char* surf = surf_available() ? "yes" : "no (dlib not found when built)";
  const char* mesh = tsdf_available() ? "yes" : "no (OpenVDB not found when built)";
  const char* occupancy = occupancy_available() ? "yes" : "no (OctoMap not found when built)";
  return fmt::format("{}\ng2o solver: {}\nSURF: {}\nmeshes: {}\noccupancy maps: {}", program_name(), g2o,
                     surf, mesh, occupancy);
}

}  // namespace kinloop
