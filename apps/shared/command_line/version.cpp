#include "apps/shared/command_line/version.hpp"

#include <vector>

#include <fmt/format.h>

#include "apps/shared/files/download.hpp"
#include "dense/mesh/simplify_mesh.hpp"
#include "dense/mesh/tsdf_volume.hpp"
#include "dense/occupancy.hpp"
#include "drivers/archives/unpack_archive.hpp"
#include "drivers/datasets/reading/images/video_reader.hpp"
#include "drivers/image_files/webp.hpp"
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
namespace {

/// An optional part: what it gives, and the line that adds it to the sources' next build. Empty: its name for
/// scripts/install_dependencies.sh, as all parts have it that distributions package.
struct Part {
  const char* name;
  bool in;
  const char* gives;
  const char* add = "";
};

std::string state_of(const Part& part) {
  if (part.in) return "yes";
  const std::string add =
      *part.add != 0 ? std::string(part.add)
                     : fmt::format("scripts/install_dependencies.sh --program --with '{}'", part.name);
  return fmt::format("no ({}; to add it: {}, and build again)", part.gives, add);
}

}  // namespace

std::string version_text() {
  const std::vector<Part> parts{
      {"g2o solver", pose_graph_solver_available(PoseGraphSolver::kG2o), "kinloop optimize --solver g2o"},
      {"SURF", surf_available(), "SURF in kinloop features"},
      {"ChArUco boards", charuco_available(), "kinloop calibrate --board charuco:..."},
      {"Kinect 1", kinect1_available(), "the live camera kinect1"},
      {"Kinect 2", kinect2_available(), "the live camera kinect2", "libfreenect2 (docs/cameras.md)"},
      {"OpenNI2", openni2_available(), "the live camera openni2"},
      {"RealSense", realsense_available(), "the live camera realsense", "librealsense2 (docs/cameras.md)"},
      {"Orbbec", orbbec_available(), "the live camera orbbec", "OrbbecSDK 2 (docs/cameras.md)"},
      {"OAK", oak_available(), "the live camera oak", "depthai 3 (docs/cameras.md)"},
      {"ROS node", KINLOOP_ROS_FOUND != 0, "a node of ROS 1; bags are read without it"},
      {"Python", KINLOOP_PYTHON_FOUND != 0, "import kinloop",
       "scripts/install_dependencies.sh --program --with Python, configure with -DKINLOOP_PYTHON=ON"},
      {"video", video_available(), "recordings of Stray Scanner and the Azure Kinect"},
      {"WebP images", webp_available(), "WebP as colour"},
      {"archives", archives_available(), ".zip, .r3d and .tar as input"},
      {"downloads", download_available(), "kinloop fetch"},
      {"distributed training", mpi_available(), "kinloop vocab on several machines, by MPI"},
      {"meshes", tsdf_available(), "kinloop mesh"},
      {"simplified meshes", mesh_simplification_available(), "kinloop mesh --triangles and --manifold"},
      {"occupancy maps", occupancy_available(), "kinloop export --octomap"},
      {"viewer and report pages", KINLOOP_PAGES_FOUND != 0,
       "the live page, kinloop view and the pictures of report.html"}};
  std::string text = program_name();
  for (const Part& part : parts) text += fmt::format("\n{}: {}", part.name, state_of(part));
  return text;
}

}  // namespace kinloop
