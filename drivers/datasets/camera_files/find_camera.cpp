#include "drivers/datasets/camera_files/find_camera.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "drivers/datasets/folder_contents.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/lower_case.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

/// How much a name tells.
enum class CameraName {
  kNone,
  kPossible,  ///< tried; ignored if it holds no camera
  kCertain,   ///< of a camera: an error if it holds none
};

bool contains_one_of(const std::string& text, std::initializer_list<const char*> parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](const char* part) { return text.find(part) != std::string::npos; });
}

CameraName judge_name(const fs::path& name, bool is_above) {
  const std::string stem = lower_case(name.stem().string()), ending = lower_case(name.extension().string());
  const bool values = ending == ".json" || ending == ".yaml" || ending == ".yml" || ending == ".xml";
  const bool array = ending == ".npy";  // often of something else, such as intrinsics of each frame
  if (stem.starts_with('.') || (!values && !array && ending != ".txt")) return CameraName::kNone;
  if (contains_one_of(stem, {"extrinsic", "pose", "traj", "time", "associat", "groundtruth"}))
    return CameraName::kNone;
  const bool certain = stem == "k" || stem == "cam_k" || stem == "camera_info" || stem == "transforms" ||
                       stem.find("intrinsic") != std::string::npos || (values && stem == "camera");
  if (array) return certain ? CameraName::kPossible : CameraName::kNone;
  if (certain) return CameraName::kCertain;
  const bool possible =
      contains_one_of(stem, {"cam", "calib"}) || stem.ends_with("_k") || (values && !is_above);
  return possible ? CameraName::kPossible : CameraName::kNone;
}

bool is_name_of_depth(const std::string& file) {
  return contains_one_of(lower_case(fs::path(file).filename().string()), {"depth", "infra", "_ir", "ir_"});
}

std::optional<CameraDescription> try_camera(const fs::path& file, CameraName name) {
  constexpr uintmax_t kMostBytes = 1 << 20;  // of a file that is only tried
  if (name == CameraName::kCertain) return read_camera_description(file);
  std::error_code absent;
  if (fs::file_size(file, absent) > kMostBytes || absent) return std::nullopt;
  try {
    return find_description(file);
  } catch (const CameraPartError&) {
    throw;  // it is a camera; without that part it would be another one
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::vector<CameraDescription> cameras_in(const fs::path& folder, bool is_above) {
  constexpr size_t kMostTried = 50;  // some datasets have a file for each frame
  std::vector<CameraDescription> found;
  size_t tried = 0;
  const FolderContents contents(folder);
  for (const std::string& file : contents.files()) {
    const CameraName name = judge_name(file, is_above);
    if (name == CameraName::kNone || ++tried > kMostTried) continue;
    if (auto description = try_camera(folder / file, name)) found.push_back(std::move(*description));
  }
  return found;
}

/// Folders of a sequence in which its camera may be.
constexpr std::array kCameraFolders = {"",      "intrinsic", "intrinsics", "calibration",
                                       "calib", "camera",    "sparse/0",   "colmap/sparse/0"};

std::vector<CameraDescription> cameras_around(const fs::path& folder, bool is_above) {
  std::vector<CameraDescription> all;
  for (const char* below : kCameraFolders) {
    std::error_code absent;
    if (!fs::is_directory(folder / below, absent)) continue;
    for (CameraDescription& camera : cameras_in(*below == '\0' ? folder : folder / below, is_above))
      all.push_back(std::move(camera));
  }
  return all;
}

/// What a description states beyond the intrinsics.
int statements(const CameraDescription& c) {
  return int{c.has_size()} + int{c.has_depth_scale} + int{c.has_fps} + int{c.camera.color.has_distortion()};
}

CameraDescription only_camera(const std::vector<CameraDescription>& found) {
  const auto is_of_color = [](const CameraDescription& c) { return !is_name_of_depth(c.source); };
  const auto first = std::find_if(found.begin(), found.end(), is_of_color);
  CameraDescription best = first == found.end() ? found.front() : *first;
  const bool any_kind = first == found.end();
  for (const CameraDescription& camera : found) {
    if (!any_kind && !is_of_color(camera)) {
      if (!agree(camera, best))
        log::warn("{}: differs from {}; depth is taken as registered to colour", camera.source, best.source);
      continue;
    }
    if (!agree(camera, best)) {
      throw InputError(fmt::format("{} and {}: cameras that differ; choose one with --camera FILE",
                                   best.source, camera.source));
    }
    if (statements(camera) > statements(best)) best = camera;
  }
  return best;
}

}  // namespace

std::optional<CameraDescription> find_camera(const fs::path& folder, const fs::path& given) {
  const auto absolute = [](const fs::path& path) { return fs::absolute(path / "").lexically_normal(); };
  const auto depth_of = [&](const fs::path& path) { return std::distance(path.begin(), path.end()); };
  fs::path here = absolute(folder);
  const auto levels = std::max<std::ptrdiff_t>(1, depth_of(here) - depth_of(absolute(given)));
  for (std::ptrdiff_t above = 0; above <= levels; ++above) {
    const auto found = cameras_around(above == 0 ? folder : here.parent_path(), above > 0);
    if (!found.empty()) return only_camera(found);
    here = here.parent_path().parent_path() / "";
  }
  return std::nullopt;
}

}  // namespace kinloop
