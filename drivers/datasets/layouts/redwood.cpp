// Redwood (Choi et al. 2015) and Open3D: color/ (or rgb/, image/), depth/ in millimetres, a JSON file with
// Open3D's "intrinsic_matrix" in column order, and perhaps trajectory.log.

#include <array>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/frame_masks.hpp"
#include "drivers/datasets/reading/image_pairs.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/datasets/reading/two_lenses.hpp"
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
  const bool fits = contents.has_folder("depth") && !color.empty() && !camera.empty();
  return fits ? fmt::format("{}/ depth/ {}", color, camera) : "";
}

RgbdCamera read_open3d_camera(const fs::path& file) {
  constexpr double kMillimetres = 1000;
  const auto json = read_json(file);
  const cv::Size size = checked_size(number_at(json, "width", file), number_at(json, "height", file), file);
  const auto k = numbers_at(json, "intrinsic_matrix", 9, file);
  const PinholeCamera lens = checked_lens(make_lens(size, k[0], k[4], k[6], k[7]), file);
  const double scale = json.contains("depth_scale") ? number_at(json, "depth_scale", file) : kMillimetres;
  return camera_of({lens, lens, {}, {}}, scale, file);
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
  sequence.camera = read_open3d_camera(folder / intrinsics_name(contents));
  pair_folders(folder / color_folder(contents), folder / "depth", sequence.camera->fps, sequence);
  find_masks(folder, sequence);
  if (sequence.stamps_measured) sequence.camera->fps = median_rate_hz(sequence.frames, sequence.camera->fps);
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
