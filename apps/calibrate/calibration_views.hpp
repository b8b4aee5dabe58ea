#pragma once
// In: folders of images. Out: board detections, with a summary on the terminal.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate_arguments.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/rgbd_camera.hpp"
#include "tools/calibration/find_board.hpp"
#include "tools/calibration/rig.hpp"

namespace kinloop {

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
