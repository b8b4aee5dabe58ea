#pragma once
// The arguments of kinloop calibrate.

#include <filesystem>
#include <string>
#include <vector>

#include "apps/calibrate/live_capture.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "tools/calibration/board.hpp"
#include "tools/calibration/options.hpp"

namespace kinloop {

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

}  // namespace kinloop
