// Record3D, an unpacked .r3d: metadata (JSON with "w", "h", "dw", "dh", "K" in column order, "fps", "poses"
// as qx qy qz qw tx ty tz of ARKit, "frameTimestamps"), rgbd/0.jpg, rgbd/0.depth (float32 in metres,
// compressed by LZFSE, for which Debian has no library; decompressed files are read).

#include <algorithm>

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/phones/phone_camera.hpp"
#include "drivers/datasets/reading/image_pairs.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

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
      fmt::format("{}: compressed by LZFSE, which kinloop cannot read; decompress the .depth files with "
                  "the program lzfse (github.com/lzfse/lzfse): lzfse -decode -i IN -o OUT",
                  file.string()));
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
  sequence.camera->fps = std::clamp(number("fps"), 1.0, 240.0);
  sequence.frames = pair_by_number(numbered_files(folder / "rgbd", "", ".jpg"),
                                   numbered_files(folder / "rgbd", "", ".depth"), sequence.camera->fps);
  require_decompressed(sequence.frames.front().depth.file, depth_size);
  sequence.stamps_measured = metadata.contains("frameTimestamps");
  const auto times =
      sequence.stamps_measured ? numbers_at(metadata, "frameTimestamps", 0, file) : std::vector<double>();
  const auto poses = metadata.find("poses");
  for (RecordedFrame& frame : sequence.frames) {
    const auto i = numbered_name(frame.color.file, "", ".jpg").value_or(0);
    if (i < times.size()) frame.stamp_ns = frame.depth_stamp_ns = checked_stamp(times[i], file);
    const bool has_pose = poses != metadata.end() && poses->is_array() && i < poses->size();
    const auto T = has_pose ? record3d_pose((*poses)[i]) : std::nullopt;
    if (T) sequence.ground_truth.push_back({frame.stamp_ns, *T});
  }
  keep_increasing(sequence);
  return sequence;
}

}  // namespace

SequenceLayout record3d_layout() {
  return {"Record3D", "metadata and rgbd/ (an unpacked .r3d)", record3d_evidence, read_record3d};
}

}  // namespace kinloop
