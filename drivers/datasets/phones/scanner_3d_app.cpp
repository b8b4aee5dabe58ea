// 3D Scanner App, "all data": frame_00000.jpg, frame_00000.json with "intrinsics" (3x3 in row order), "time"
// and ARKit's "cameraPoseARFrame" (4x4 in row order), depth_00000.png in millimetres, conf_00000.png. The app
// writes depth of more frames than colour.

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/phones/phone_camera.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

std::string scanner_3d_app_evidence(const fs::path&, const FolderContents& contents) {
  const std::string json = contents.find_file("frame_", ".json");
  return json.empty() || contents.find_file("depth_", ".png").empty() ? "" : json;
}

/// Sets the times of the file, or 30 Hz, and the confidence of a frame.
void complete_frame(const nlohmann::json& json, const fs::path& file, RecordedFrame& frame) {
  if (json.contains("time")) frame.stamp_ns = checked_stamp(number_at(json, "time", file), file);
  frame.depth_stamp_ns = frame.stamp_ns;
  const std::string depth = frame.depth.file.filename().string();
  const fs::path confidence = file.parent_path() / ("conf_" + depth.substr(depth.find('_') + 1));
  std::error_code absent;
  if (fs::exists(confidence, absent)) frame.confidence = confidence;
}

RecordedSequence read_scanner_3d_app(const fs::path& folder) {
  constexpr double kRate_hz = 60;
  RecordedSequence sequence;
  sequence.layout = "3D Scanner App folder";
  sequence.frames = pair_by_number(numbered_files(folder, "frame_", ".jpg"),
                                   numbered_files(folder, "depth_", ".png"), kRate_hz);
  const cv::Size size = image_size(sequence.frames, &RecordedFrame::color);
  std::vector<PinholeCamera> lenses;
  for (RecordedFrame& frame : sequence.frames) {
    const fs::path file = fs::path(frame.color.file).replace_extension(".json");
    const auto json = read_json(file);
    const auto k = numbers_at(json, "intrinsics", 9, file);
    lenses.push_back(make_lens(size, k[0], k[4], k[2], k[5]));
    complete_frame(json, file, frame);
    const auto pose = numbers_at(json, "cameraPoseARFrame", 16, file);
    if (const auto T = rigid_motion(*matrix_of(std::span(pose).first(16))))
      sequence.ground_truth.push_back({frame.stamp_ns, from_arkit(*T)});
  }
  finish_phone_sequence(sequence, lenses, folder);
  return sequence;
}

}  // namespace

SequenceLayout scanner_3d_app_layout() {
  return {"3D Scanner App", "frame_00000.json, frame_00000.jpg and depth_00000.png", scanner_3d_app_evidence,
          read_scanner_3d_app};
}

}  // namespace kinloop
