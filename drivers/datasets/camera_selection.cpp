#include "drivers/datasets/camera_selection.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "drivers/datasets/camera_files/find_camera.hpp"
#include "drivers/datasets/camera_files/fit_to_images.hpp"
#include "drivers/datasets/folder_contents.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
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

using GivenCamera = std::variant<RgbdCamera, CameraDescription>;

GivenCamera described_camera(const CameraDescription& description) {
  if (description.is_complete) return description.camera;
  return description;
}

GivenCamera given_by(const CameraArgument& argument) {
  if (const auto* camera = std::get_if<RgbdCamera>(&argument)) return *camera;
  if (const auto* description = std::get_if<CameraDescription>(&argument)) return *description;
  const auto& preset_or_file = std::get<std::string>(argument);
  if (const auto preset = camera_preset(preset_or_file)) return *preset;
  std::error_code absent;
  if (std::filesystem::exists(preset_or_file, absent))
    return described_camera(read_camera_description(preset_or_file));
  throw InputError(
      fmt::format("--camera {}: neither a file nor a preset ({})", preset_or_file, kPresetNames));
}

/// The lists of the benchmark name their recording in a comment, "# file: 'rgbd_dataset_freiburg1_rpy.bag'",
/// also in a folder of another name.
std::optional<RgbdCamera> preset_of_lists(const std::filesystem::path& folder) {
  constexpr int kMostLines = 3;
  constexpr std::string_view kBenchmark = "rgbd_dataset_";
  for (const char* list : {"rgb.txt", "depth.txt", "groundtruth.txt"}) {
    std::error_code absent;
    if (!std::filesystem::is_regular_file(folder / list, absent)) continue;
    std::ifstream file(folder / list);
    std::string line;
    for (int i = 0; i < kMostLines && std::getline(file, line) && line.starts_with('#'); ++i) {
      const size_t begin = line.find(kBenchmark);
      if (begin == std::string::npos) continue;
      const std::string name = line.substr(begin, line.find_first_of("'\" \r", begin) - begin);
      auto preset = preset_in_name(name);
      if (!preset) continue;
      log::info("camera of {}, the recording that {} names", name, (folder / list).string());
      return preset;
    }
  }
  return std::nullopt;
}

/// The camera of a sequence that the user says nothing of.
GivenCamera camera_found(const std::filesystem::path& path, const std::filesystem::path& given_path,
                         const RecordedSequence& sequence) {
  std::error_code absent;
  if (const auto file = path / "camera.yaml"; std::filesystem::exists(file, absent))
    return described_camera(read_camera_description(file));
  if (sequence.camera) return *sequence.camera;
  const auto folder = std::filesystem::is_directory(path, absent) ? path : path.parent_path();
  if (const auto description = find_camera(folder, given_path.empty() ? folder : given_path))
    return described_camera(*description);
  if (const auto preset = preset_of_lists(folder)) return *preset;
  reject_without_camera(path, sequence);
}

}  // namespace

std::optional<RgbdCamera> preset_of_folder(const std::filesystem::path& folder) {
  return preset_in_name(folder_name(folder));
}

CameraDescription parse_intrinsics(const std::string& text) {
  constexpr size_t kIntrinsics = 4;
  std::vector<double> numbers;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    double number = 0;
    const auto [last, error] = std::from_chars(text.data() + begin, text.data() + end, number);
    if (error != std::errc() || last != text.data() + end || !std::isfinite(number)) {
      numbers.clear();
      break;
    }
    numbers.push_back(number);
    begin = end + 1;
  }
  constexpr size_t kWithFour = 8, kWithFive = 9;
  if (numbers.size() != kIntrinsics && numbers.size() != kWithFour && numbers.size() != kWithFive) {
    throw UsageError(
        fmt::format("--intrinsics {}: expected fx,fy,cx,cy or fx,fy,cx,cy,k1,k2,p1,p2,k3 in pixels, "
                    "e.g. 525,525,319.5,239.5",
                    text));
  }
  CameraDescription description;
  description.source = "--intrinsics " + text;
  description.format = "as given";
  try {
    set_intrinsics(description, numbers[0], numbers[1], numbers[2], numbers[3]);
    set_distortion(description, std::span(numbers).subspan(kIntrinsics));
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
  return description;
}

RgbdCamera camera_of_sequence(const std::filesystem::path& path, RecordedSequence& sequence,
                              const std::optional<CameraArgument>& camera_argument,
                              std::optional<double> depth_scale, const std::filesystem::path& given_path) {
  const GivenCamera given =
      camera_argument ? given_by(*camera_argument) : camera_found(path, given_path, sequence);
  if (depth_scale && is_metric(sequence.depth_encoding))
    log::warn("--depth-scale is not used: the depth of {} is in metres", path.string());
  if (const auto* description = std::get_if<CameraDescription>(&given))
    return fit_to_images(*description, sequence, depth_scale);
  RgbdCamera camera = std::get<RgbdCamera>(given);
  camera.depth_scale = depth_scale.value_or(camera.depth_scale);
  if (const auto size = fit_depth_size(sequence, camera))
    log::info("depth of {} of {} x {}, taken as of the same view as colour has", path.string(), size->width,
              size->height);
  return camera;
}

RgbdCamera given_camera(const CameraArgument& camera_argument) {
  const GivenCamera given = given_by(camera_argument);
  if (const auto* description = std::get_if<CameraDescription>(&given))
    return camera_without_images(*description);
  return std::get<RgbdCamera>(given);
}

bool states_depth_scale(const CameraArgument& camera_argument) {
  const GivenCamera given = given_by(camera_argument);
  const auto* description = std::get_if<CameraDescription>(&given);
  return description == nullptr || description->has_depth_scale;
}

RgbdCamera choose_camera(const std::filesystem::path& folder,
                         const std::optional<CameraArgument>& camera_argument) {
  if (camera_argument) return given_camera(*camera_argument);
  constexpr bool kCameraKnown = false;
  const auto file = folder / "camera.yaml";
  if (std::filesystem::exists(file)) return read_camera_file(file);
  if (const auto preset = preset_of_folder(folder)) return *preset;
  reject_sequence(folder, kCameraKnown);
}

}  // namespace kinloop
