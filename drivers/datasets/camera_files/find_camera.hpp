#pragma once
// In: the folder of a sequence without a camera of its own. Out: the camera file that lies in it or beside
// it.

#include <filesystem>
#include <optional>

#include "drivers/datasets/camera_files/camera_description.hpp"

namespace kinloop {

/// Returns the camera described by a file in the folder or one of its folders for calibration, else in the
/// folder above, or in the next one above up to `given`, the folder that the user gave. Names such as K.txt
/// or *intrinsic*.json are those of cameras; other JSON and YAML files in the folder are tried. A file that
/// is said to be of depth is used only if there is no other. Throws InputError that names two files which
/// differ, or a file with the name of a camera that cannot be read.
std::optional<CameraDescription> find_camera(const std::filesystem::path& folder,
                                             const std::filesystem::path& given);

}  // namespace kinloop
