#pragma once
// In: a sequence and what the user says of its camera. Out: the camera; never guessed silently.

#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "drivers/datasets/camera_files/camera_description.hpp"
#include "drivers/datasets/recorded_sequence.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// What a user gives for the camera: a preset or a camera file in any format, the calibration itself, or what
/// --intrinsics states.
using CameraArgument = std::variant<std::string, RgbdCamera, CameraDescription>;

/// Reads --intrinsics "fx,fy,cx,cy[,k1,k2,p1,p2,k3]". Throws UsageError for anything else.
CameraDescription parse_intrinsics(const std::string& text);

/// Returns the camera of a sequence: `camera_argument` if given, else camera.yaml in the folder, else that of
/// the layout, else that of a camera file in the folder or above it, up to `given_path`, the folder in which
/// the user asked for a sequence (empty: the same one). What a file does not state is taken from the images,
/// see fit_to_images, which notes a guessed unit in `sequence`. `depth_scale` replaces the unit of depth.
/// Throws InputError with the remedy if there is no camera, or it cannot be that of the images.
RgbdCamera camera_of_sequence(const std::filesystem::path& path, RecordedSequence& sequence,
                              const std::optional<CameraArgument>& camera_argument,
                              std::optional<double> depth_scale = {},
                              const std::filesystem::path& given_path = {});

/// Returns the camera that the user gives for a source whose images are not known yet, such as a bag. Throws
/// InputError if a camera file does not state the size of the images.
RgbdCamera given_camera(const CameraArgument& camera_argument);

/// Returns whether what the user gives states the unit of depth: a camera file of another program may not.
bool states_depth_scale(const CameraArgument& camera_argument);

/// Returns the camera of a folder: `camera_argument` if given, else camera.yaml in it, else the TUM preset
/// contained in its name ("rgbd_dataset_freiburg1_desk"). Throws InputError with the remedy if there is none.
RgbdCamera choose_camera(const std::filesystem::path& folder,
                         const std::optional<CameraArgument>& camera_argument = {});

/// Returns the TUM preset contained in the folder's name; nullopt if there is none or several.
std::optional<RgbdCamera> preset_of_folder(const std::filesystem::path& folder);

}  // namespace kinloop
