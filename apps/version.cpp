#include "apps/version.hpp"

#include <fmt/format.h>

#include "kinloop/optimize/pose_graph.hpp"

namespace kinloop {

std::string version_text() {
  const char* g2o = pose_graph_solver_available("g2o") ? "yes" : "no (not found when built)";
  return fmt::format("kinloop {}\ng2o solver: {}", KINLOOP_VERSION, g2o);
}

}  // namespace kinloop
