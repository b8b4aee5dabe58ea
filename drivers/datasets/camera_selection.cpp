#include "drivers/datasets/camera_selection.hpp"

#include <array>

#include <fmt/format.h>

#include "drivers/datasets/folder_contents.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "kinloop/sensor/camera/camera_presets.hpp"

namespace kinloop {
namespace {

constexpr std::array<std::string_view, 3> kTumPresets = {"freiburg1", "freiburg2", "freiburg3"};
constexpr const char* kPresetNames = "freiburg1, freiburg2, freiburg3, icl";

/// The TUM preset contained in `name`; nullopt if there is none or several.
std::optional<RgbdCamera> preset_in_name(const std::string& name) {
  std::optional<RgbdCamera> found;
  for (const auto preset : kTumPresets) {
    if (name.find(preset) == std::string::npos) continue;
    if (found) return std::nullopt;
    found = camera_preset(preset);
  }
  return found;
}

RgbdCamera named_camera(const std::string& preset_or_file) {
  if (const auto preset = camera_preset(preset_or_file)) return *preset;
  if (std::filesystem::exists(preset_or_file)) return read_camera_file(preset_or_file);
  throw InputError(
      fmt::format("--camera {}: neither a file nor a preset ({})", preset_or_file, kPresetNames));
}

}  // namespace

std::optional<RgbdCamera> preset_of_folder(const std::filesystem::path& folder) {
  return preset_in_name(folder_name(folder));
}

RgbdCamera choose_camera(const std::filesystem::path& folder,
                         const std::optional<CameraArgument>& camera_argument) {
  if (camera_argument) {
    if (const auto* camera = std::get_if<RgbdCamera>(&*camera_argument)) return *camera;
    return named_camera(std::get<std::string>(*camera_argument));
  }
  constexpr bool kCameraKnown = false;
  const auto file = folder / "camera.yaml";
  if (std::filesystem::exists(file)) return read_camera_file(file);
  if (const auto preset = preset_of_folder(folder)) return *preset;
  reject_sequence(folder, kCameraKnown);
}

}  // namespace kinloop
