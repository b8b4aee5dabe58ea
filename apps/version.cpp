#include "apps/version.hpp"

#include <fmt/format.h>

#include "apps/download.hpp"
#include "kinloop/compare/detectors.hpp"
#include "kinloop/features/surf.hpp"
#include "kinloop/optimize/pose_graph.hpp"
#include "kinloop/sensor/bag_source.hpp"
#include "kinloop/sensor/kinect1_source.hpp"
#include "kinloop/sensor/kinect2_source.hpp"

namespace kinloop {

std::string version_text() {
  const char* g2o = pose_graph_solver_available("g2o") ? "yes" : "no (not found when built)";
  const char* surf = surf_available() ? "yes" : "no (dlib not found when built)";
  const char* pages = KINLOOP_PAGES_FOUND ? "yes" : "no (npm not found, or without network, when built)";
  const auto part = [](bool in, const char* what) {
    return in ? std::string("yes") : fmt::format("no ({} not found when built)", what);
  };
  return fmt::format(
      "kinloop {}\ng2o solver: {}\nSURF: {}\nKinect 1: {}\nKinect 2: {}\nROS bags: {}\nDownloads: {}\nviewer and report pages: {}",
      KINLOOP_VERSION, g2o, surf, part(kinect1_available(), "libfreenect"),
      part(kinect2_available(), "libfreenect2"), part(bags_available(), "librosbag-storage"),
      part(download_available(), "curl or libarchive"), pages);
}

}  // namespace kinloop
