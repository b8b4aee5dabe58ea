#pragma once
// In: folders of stills. Out: what they show of the board, with what was found said on the terminal.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate_arguments.hpp"
#include "kinloop/geometry/camera.hpp"
#include "tools/calibration/find_board.hpp"
#include "tools/calibration/rig.hpp"

namespace kinloop {

/// The boards in these stills.
BoardSearch search_boards(const std::vector<std::filesystem::path>& stills,
                          const CalibrateArguments& arguments);

/// Shots of the folder in which both cameras see the board.
std::vector<PairedView> find_pairs(const CalibrateArguments& arguments);

/// Where the depth image of a pair lies.
std::filesystem::path depth_path_of(const std::string& pair_name, const CalibrateArguments& arguments);

/// A camera that is known (from a file, by `pick`), or stills to estimate it from along with the pairs.
LensSource lens_source(const std::string& argument, const CalibrateArguments& arguments,
                       const std::function<std::optional<PinholeCamera>(const RgbdCamera&)>& pick);

}  // namespace kinloop
