// Redwood (Choi et al. 2015) and Open3D: color/ (or rgb/, image/), depth/ in millimetres, a JSON file with
// Open3D's "intrinsic_matrix" in column order, and perhaps trajectory.log.

#include <array>

#include <fmt/format.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/datasets/reading/lists/frame_masks.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/lists/pair_images.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

std::string intrinsics_name(const FolderContents& contents) {
  for (const std::string& name : contents.files()) {
    const bool camera = name.find("intrinsic") != std::string::npos || name.starts_with("camera");
    if (camera && name.ends_with(".json") && name.find("trajectory") == std::string::npos) return name;
  }
  return {};
}

std::string redwood_evidence(const fs::path&, const FolderContents& contents) {
  const std::string color = color_folder(contents), camera = intrinsics_name(contents);
  const bool fits = !depth_folder(contents).empty() && !color.empty() && !camera.empty();
  return fits ? fmt::format("{}/ {}/ {}", color, depth_folder(contents), camera) : "";
}

/// Open3D's own files state the size of the images, and its depth is in millimetres. Any other camera file is
/// to be fitted to the images: nullopt.
std::optional<RgbdCamera> open3d_camera(const CameraDescription& description, const fs::path& file) {
  constexpr double kMillimetres = 1000;
  if (!description.has_size() || !read_json(file).contains("intrinsic_matrix")) return std::nullopt;
  RgbdCamera camera = description.camera;
  checked_lens(camera.color, file);
  if (!description.has_depth_scale) camera.depth_scale = kMillimetres;
  return camera;
}

/// Three indices, the first of which is that of the frame, and a 4x4 matrix each.
Trajectory read_log(const fs::path& file, const std::vector<RecordedFrame>& frames) {
  constexpr size_t kIndices = 3, kEntry = kIndices + 16;
  const auto v = read_numbers(file);
  if (v.size() % kEntry != 0)
    throw InputError(fmt::format("{}: {} numbers, where each pose has {}; copy it again", file.string(),
                                 v.size(), kEntry));
  Trajectory truth;
  for (size_t i = 0; i < v.size(); i += kEntry) {
    const double frame = v[i];
    const auto T = rigid_motion(*matrix_of(std::span(v).subspan(i + kIndices, 16)));
    if (!T || !(frame >= 0) || frame >= static_cast<double>(frames.size())) continue;
    truth.push_back({frames[static_cast<size_t>(frame)].stamp_ns, *T});
  }
  return sorted_by_time(std::move(truth));
}

RecordedSequence read_redwood(const fs::path& folder) {
  const FolderContents contents(folder);
  RecordedSequence sequence;
  sequence.layout = "Redwood or Open3D folder";
  const fs::path file = folder / intrinsics_name(contents);
  const CameraDescription description = read_camera_description(file);
  sequence.camera = open3d_camera(description, file);
  pair_folders(folder / color_folder(contents), folder / depth_folder(contents), description.camera.fps,
               sequence);
  find_masks(folder, sequence);
  if (sequence.stamps_measured && sequence.camera)
    sequence.camera->fps = median_rate_hz(sequence.frames, sequence.camera->fps);
  for (const char* name : {"trajectory.log", "scene/trajectory.log", "pose.log"}) {
    std::error_code absent;
    if (!fs::exists(folder / name, absent)) continue;
    sequence.ground_truth = read_log(folder / name, sequence.frames);
    break;
  }
  return sequence;
}

}  // namespace

SequenceLayout redwood_layout() {
  return {"Redwood or Open3D", "color/, depth/ and camera_intrinsic.json", redwood_evidence, read_redwood};
}

}  // namespace kinloop
