#pragma once
// In: a sequence folder and the --camera argument. Out: the camera; never guessed silently.

#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// What a user gives for the camera: a preset name or a camera.yaml, or the calibration itself.
using CameraArgument = std::variant<std::string, RgbdCamera>;

/// Returns the camera of a sequence: `camera_argument` if given, else camera.yaml
/// in the folder, else the TUM preset contained in the folder's name ("rgbd_dataset_freiburg1_desk"). Throws
/// InputError with the remedy if there is none.
RgbdCamera choose_camera(const std::filesystem::path& folder,
                         const std::optional<CameraArgument>& camera_argument = {});

/// Returns the TUM preset contained in the folder's name; nullopt if there is none or several.
std::optional<RgbdCamera> preset_of_folder(const std::filesystem::path& folder);

}  // namespace kinloop
