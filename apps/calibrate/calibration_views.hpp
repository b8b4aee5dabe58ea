#pragma once
// In: the arguments of kinloop calibrate. Out: the detections of the board in its images, with a summary on
// the terminal.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/calibrate/live_capture.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "tools/calibration/board.hpp"
#include "tools/calibration/find_board.hpp"
#include "tools/calibration/options.hpp"
#include "tools/calibration/rig.hpp"

namespace kinloop {

/// The arguments of kinloop calibrate.
struct CalibrateArguments {
  std::filesystem::path folder;
  std::string board = "5x7";
  double square_m = 0, marker_m = 0;
  std::filesystem::path output = "camera.yaml";
  std::string color, infrared;   ///< a folder of images or a camera.yaml
  std::filesystem::path camera;  ///< of `depth`
  double depth_scale = 0;        ///< units per metre
  LiveCaptureOptions live;
  double fps = 30;
  std::vector<std::string> assignments;
  int threads = hardware_threads();

  /// Returns the board. Throws UsageError if it is invalid or not supported by this build.
  [[nodiscard]] Board chosen_board() const;

  /// Returns the options. Throws UsageError if they contradict each other.
  [[nodiscard]] CalibrationOptions options() const;

  /// Returns the path of the output with another extension.
  [[nodiscard]] std::filesystem::path sibling_file(const char* ending) const;
};

/// Detects the board in these images.
BoardSearch search_boards(const std::vector<std::filesystem::path>& stills,
                          const CalibrateArguments& arguments);

/// Returns the shots of the folder in which both cameras see the board.
std::vector<PairedView> find_pairs(const CalibrateArguments& arguments);

/// Returns the path of a pair's depth image.
std::filesystem::path depth_path_of(const std::string& pair_name, const CalibrateArguments& arguments);

/// Returns a known camera (read from a file by `pick`), or images to estimate it from along with the pairs.
LensSource lens_source(const std::string& argument, const CalibrateArguments& arguments,
                       const std::function<std::optional<PinholeCamera>(const RgbdCamera&)>& pick);

}  // namespace kinloop
