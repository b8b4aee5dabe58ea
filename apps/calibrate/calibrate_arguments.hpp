#pragma once
// What the user says to kinloop calibrate.

#include <filesystem>
#include <string>
#include <vector>

#include "apps/calibrate/live_capture.hpp"
#include "kinloop/base/parallel_for.hpp"
#include "tools/calibration/board.hpp"
#include "tools/calibration/options.hpp"

namespace kinloop {

struct CalibrateArguments {
  std::filesystem::path folder;
  std::string board = "5x7";
  double square_m = 0, marker_m = 0;
  std::filesystem::path output = "camera.yaml";
  std::string color, infrared;   ///< a folder of stills or a camera.yaml
  std::filesystem::path camera;  ///< of `depth`
  double depth_scale = 0;        ///< units per metre
  LiveCaptureOptions live;
  double fps = 30;
  std::vector<std::string> assignments;
  int threads = hardware_threads();

  /// The board. Throws UsageError where it is none, or not for this build.
  [[nodiscard]] Board chosen_board() const;

  /// The options. Throws UsageError where they do not go together.
  [[nodiscard]] CalibrationOptions options() const;

  /// A file named like the output but for its ending.
  [[nodiscard]] std::filesystem::path sibling_file(const char* ending) const;
};

}  // namespace kinloop
