// Record3D exports colour and depth as images: rgb/0.jpg, depth/0.exr in metres, confidence/0.png, and
// metadata.json or metadata, which an unpacked .r3d has, too: metadata (JSON with "w", "h", "dw", "dh", "K"
// in column order, "fps", "poses" as qx qy qz qw tx ty tz of ARKit, "frameTimestamps"), rgbd/0.jpg,
// rgbd/0.depth (float32 in metres, compressed by LZFSE, for which Debian has no library; decompressed files
// are read).

#include <algorithm>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/phones/phone_camera.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/camera/registration.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

std::string record3d_evidence(const fs::path&, const FolderContents& contents) {
  return contents.has_file("metadata") && contents.has_folder("rgbd") ? "metadata, rgbd/" : "";
}

void require_decompressed(const fs::path& file, cv::Size size) {
  const std::string bytes = read_file(file);
  const auto expected = static_cast<size_t>(size.width) * static_cast<size_t>(size.height) * sizeof(float);
  if (bytes.size() == expected) return;
  if (!bytes.starts_with("bvx")) return;  // damaged, like other frames may be
  throw InputError(
      fmt::format("{}: compressed by LZFSE, which kinloop cannot read; export EXR and JPEG from Record3D "
                  "instead, or decompress the .depth files with the program lzfse "
                  "(github.com/lzfse/lzfse): lzfse -decode -i IN -o OUT",
                  file.string()));
}

/// The folder itself or its EXR_RGBD/.
fs::path exported_folder(const fs::path& folder) {
  std::error_code absent;
  return fs::is_directory(folder / "EXR_RGBD", absent) ? folder / "EXR_RGBD" : folder;
}

std::string metadata_name(const FolderContents& contents) {
  for (const char* name : {"metadata.json", "metadata"}) {
    if (contents.has_file(name)) return name;
  }
  return {};
}

std::string record3d_export_evidence(const fs::path& path, const FolderContents&) {
  const fs::path folder = exported_folder(path);
  const FolderContents contents(folder);
  const bool folders = contents.has_folder("rgb") && contents.has_folder("depth");
  if (!folders || metadata_name(contents).empty()) return {};
  const std::string depth = FolderContents(folder / "depth").find_file("", ".exr");
  return depth.empty() ? depth : fmt::format("{}, depth/{}", metadata_name(contents), depth);
}

/// The lens of each frame if they are there, else the one of all.
std::vector<PinholeCamera> record3d_lenses(const nlohmann::json& metadata, cv::Size size,
                                           const fs::path& file) {
  std::vector<PinholeCamera> lenses;
  const auto list = metadata.find("perFrameIntrinsicCoeffs");
  if (list != metadata.end() && list->is_array()) {
    for (size_t i = 0; i < list->size(); ++i) {
      const auto& k = (*list)[i];
      const bool four_numbers = k.is_array() && k.size() >= 4 && k[0].is_number() && k[1].is_number() &&
                                k[2].is_number() && k[3].is_number();
      if (four_numbers)
        lenses.push_back(
            make_lens(size, k[0].get<double>(), k[1].get<double>(), k[2].get<double>(), k[3].get<double>()));
    }
  }
  if (!lenses.empty()) return lenses;
  const auto k = numbers_at(metadata, "K", 9, file);
  return {make_lens(size, k[0], k[4], k[6], k[7])};
}

std::optional<SE3> record3d_pose(const nlohmann::json& pose) {
  constexpr size_t kPose = 7;
  if (!pose.is_array() || pose.size() != kPose) return std::nullopt;
  std::vector<double> v;
  for (const size_t i : {4U, 5U, 6U, 0U, 1U, 2U, 3U}) {
    if (!pose[i].is_number()) return std::nullopt;
    v.push_back(pose[i].get<double>());
  }
  const auto T = motion_of(v);
  return T ? std::optional(from_arkit(*T)) : std::nullopt;
}

/// Sets times and poses, which are lists by the numbers of the images.
void add_times_and_poses(const nlohmann::json& metadata, const fs::path& file, RecordedSequence& sequence) {
  sequence.stamps_measured = metadata.contains("frameTimestamps");
  const auto times =
      sequence.stamps_measured ? numbers_at(metadata, "frameTimestamps", 0, file) : std::vector<double>();
  const auto poses = metadata.find("poses");
  for (RecordedFrame& frame : sequence.frames) {
    const auto i = numbered_name(frame.color.file, "", frame.color.file.extension().string()).value_or(0);
    if (i < times.size()) frame.stamp_ns = frame.depth_stamp_ns = checked_stamp(times[i], file);
    const bool has_pose = poses != metadata.end() && poses->is_array() && i < poses->size();
    const auto T = has_pose ? record3d_pose((*poses)[i]) : std::nullopt;
    if (T) sequence.ground_truth.push_back({frame.stamp_ns, *T});
  }
  keep_increasing(sequence);
}

double record3d_rate_hz(const nlohmann::json& metadata, const fs::path& file) {
  constexpr double kSlowest_hz = 1, kFastest_hz = 240;
  return std::clamp(number_at(metadata, "fps", file), kSlowest_hz, kFastest_hz);
}

RecordedSequence read_record3d(const fs::path& folder) {
  const fs::path file = folder / "metadata";
  const auto metadata = read_json(file);
  const auto number = [&](const char* key) { return number_at(metadata, key, file); };
  const cv::Size size = checked_size(number("w"), number("h"), file);
  const cv::Size depth_size = checked_size(number("dw"), number("dh"), file);
  RecordedSequence sequence;
  sequence.layout = "Record3D folder";
  sequence.depth_encoding = DepthEncoding::kRawFloat32;
  sequence.camera = phone_camera(record3d_lenses(metadata, size, file), depth_size, file);
  sequence.camera->depth_scale = 1;
  sequence.sensor = DepthSensorModel::kIphone;
  sequence.camera->fps = record3d_rate_hz(metadata, file);
  sequence.frames = pair_by_number(numbered_files(folder / "rgbd", "", ".jpg"),
                                   numbered_files(folder / "rgbd", "", ".depth"), sequence.camera->fps);
  require_decompressed(sequence.frames.front().depth.file, depth_size);
  add_times_and_poses(metadata, file, sequence);
  return sequence;
}

/// The lens of images of the size that metadata states, for those that were exported.
PinholeCamera of_size(const PinholeCamera& lens, cv::Size size) {
  if (size.width == lens.width) return lens;
  PinholeCamera scaled = resized(lens, size.width);
  scaled.height = size.height;
  return scaled;
}

RecordedSequence read_record3d_export(const fs::path& path) {
  const fs::path folder = exported_folder(path);
  const fs::path file = folder / metadata_name(FolderContents(folder));
  const auto metadata = read_json(file);
  RecordedSequence sequence;
  sequence.layout = "Record3D export";
  sequence.depth_encoding = DepthEncoding::kFloatImage;
  sequence.sensor = DepthSensorModel::kIphone;
  const double rate_hz = record3d_rate_hz(metadata, file);
  auto color = numbered_files(folder / "rgb", "", ".jpg");
  if (color.empty()) color = numbered_files(folder / "rgb", "", ".png");
  sequence.frames = pair_by_number(color, numbered_files(folder / "depth", "", ".exr"), rate_hz);
  const cv::Size exported = image_size(sequence.frames, &RecordedFrame::color);
  const cv::Size stated = checked_size(number_at(metadata, "w", file), number_at(metadata, "h", file), file);
  std::vector<PinholeCamera> lenses = record3d_lenses(metadata, stated, file);
  for (PinholeCamera& lens : lenses) lens = of_size(lens, exported);
  sequence.camera = phone_camera(lenses, image_size(sequence.frames, &RecordedFrame::depth), file);
  sequence.camera->depth_scale = 1;
  sequence.camera->fps = rate_hz;
  for (RecordedFrame& frame : sequence.frames) {
    const fs::path confidence = folder / "confidence" / (frame.depth.file.stem().string() + ".png");
    std::error_code absent;
    if (fs::exists(confidence, absent)) frame.confidence = confidence;
  }
  add_times_and_poses(metadata, file, sequence);
  return sequence;
}

}  // namespace

SequenceLayout record3d_export_layout() {
  return {"Record3D export", "rgb/, depth/ with .exr, and metadata.json", record3d_export_evidence,
          read_record3d_export};
}

SequenceLayout record3d_layout() {
  return {"Record3D", "metadata and rgbd/ (an unpacked .r3d)", record3d_evidence, read_record3d};
}

}  // namespace kinloop
