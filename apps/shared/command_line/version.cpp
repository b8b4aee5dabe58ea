#include "apps/shared/command_line/version.hpp"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/shared/files/download.hpp"
#include "dense/mesh/simplify_mesh.hpp"
#include "dense/mesh/tsdf_volume.hpp"
#include "dense/occupancy.hpp"
#include "drivers/datasets/reading/images/video_reader.hpp"
#include "drivers/kinect1/kinect1_source.hpp"
#include "drivers/kinect2/kinect2_source.hpp"
#include "drivers/oak/oak_source.hpp"
#include "drivers/openni2/openni2_source.hpp"
#include "drivers/orbbec/orbbec_source.hpp"
#include "drivers/realsense/realsense_source.hpp"
#include "kinloop/features/extraction/surf.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "session/process.hpp"
#include "tools/calibration/board/charuco.hpp"
#include "tools/feature_comparison/detectors.hpp"
#include "tools/vocabulary_training/communicator.hpp"

namespace kinloop {

std::string version_text() {
  const auto part = [](bool in, const char* what) {
    return in ? std::string("yes") : fmt::format("no ({} not found at build time)", what);
  };
  const std::vector<std::pair<const char*, std::string>> parts{
      {"g2o solver", part(pose_graph_solver_available(PoseGraphSolver::kG2o), "g2o")},
      {"SURF", part(surf_available(), "dlib")},
      {"ChArUco boards", part(charuco_available(), "OpenCV's aruco")},
      {"Kinect 1", part(kinect1_available(), "libfreenect")},
      {"Kinect 2", part(kinect2_available(), "libfreenect2")},
      {"OpenNI2", part(openni2_available(), "libOpenNI2")},
      {"RealSense", part(realsense_available(), "librealsense2")},
      {"Orbbec", part(orbbec_available(), "OrbbecSDK 2")},
      {"OAK", part(oak_available(), "depthai 3")},
      {"ROS node", part(KINLOOP_ROS_FOUND, "roscpp")},
      {"Python",
       KINLOOP_PYTHON_FOUND ? "yes" : "no (KINLOOP_PYTHON is off, or pybind11 2.13 was not found at build time)"},
      {"video", part(video_available(), "libavformat, libavcodec or libswscale")},
      {"downloads", part(download_available(), "curl or libarchive")},
      {"distributed training", part(mpi_available(), "MPI")},
      {"meshes", part(tsdf_available(), "OpenVDB")},
      {"simplified meshes", part(mesh_simplification_available(), "CGAL")},
      {"occupancy maps", part(occupancy_available(), "OctoMap")},
      {"viewer and report pages", part(KINLOOP_PAGES_FOUND, "npm or network access")}};
  std::string text = program_name();
  for (const auto& [name, state] : parts) text += fmt::format("\n{}: {}", name, state);
  return text;
}

}  // namespace kinloop
