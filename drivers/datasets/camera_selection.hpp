#pragma once
// In: a sequence folder and the --camera argument. Out: the camera; never guessed silently.

#include <filesystem>
#include <optional>
#include <string>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// Returns the camera of a sequence: `camera_argument` (a preset name or a file) if given, else camera.yaml
/// in the folder, else the TUM preset contained in the folder's name ("rgbd_dataset_freiburg1_desk"). Throws
/// InputError with the remedy if there is none.
RgbdCamera choose_camera(const std::filesystem::path& folder,
                         const std::optional<std::string>& camera_argument = {});

/// Returns the TUM preset contained in the folder's name; nullopt if there is none or several.
std::optional<RgbdCamera> preset_of_folder(const std::filesystem::path& folder);

}  // namespace kinloop
