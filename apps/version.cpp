#include "apps/version.hpp"

#include <fmt/format.h>

#include "kinloop/compare/detectors.hpp"
#include "kinloop/features/surf.hpp"
#include "kinloop/optimize/pose_graph.hpp"

namespace kinloop {

std::string version_text() {
  const char* g2o = pose_graph_solver_available("g2o") ? "yes" : "no (not found when built)";
  const char* surf = surf_available() ? "yes" : "no (dlib not found when built)";
  const char* pages = KINLOOP_PAGES_FOUND ? "yes" : "no (npm not found, or without network, when built)";
  return fmt::format("kinloop {}\ng2o solver: {}\nSURF: {}\nviewer and report pages: {}", KINLOOP_VERSION,
                     g2o, surf, pages);
}

}  // namespace kinloop
