#pragma once
// In: a sequence folder and what the user gave as --camera. Out: the camera; never a silent guess.

#include <filesystem>
#include <optional>
#include <string>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// The camera of a sequence: `camera_argument` (a preset's name or a file) where given, else camera.yaml in
/// the folder, else the TUM preset that the folder's name contains ("rgbd_dataset_freiburg1_desk"). Throws
/// InputError that says what to do when there is none.
RgbdCamera choose_camera(const std::filesystem::path& folder,
                         const std::optional<std::string>& camera_argument = {});

}  // namespace kinloop
