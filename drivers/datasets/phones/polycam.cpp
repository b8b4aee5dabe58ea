// Polycam, raw data: keyframes/images/STAMP.jpg, keyframes/depth/STAMP.png in millimetres,
// keyframes/confidence/STAMP.png, and keyframes/cameras/STAMP.json with the lens, ARKit's pose t_00 to t_23
// and the time in microseconds. corrected_cameras/ has poses after Polycam's own optimisation.

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/phones/phone_camera.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

/// The folder itself or its keyframes/.
fs::path keyframes_of(const fs::path& folder) {
  std::error_code absent;
  return fs::is_directory(folder / "keyframes", absent) ? folder / "keyframes" : folder;
}

std::string polycam_evidence(const fs::path& folder, const FolderContents&) {
  const FolderContents contents(keyframes_of(folder));
  const bool fits =
      contents.has_folder("images") && contents.has_folder("cameras") && contents.has_folder("depth");
  return fits ? "keyframes/ images/ cameras/ depth/" : "";
}

std::optional<SE3> polycam_pose(const fs::path& file) {
  std::error_code absent;
  if (!fs::exists(file, absent)) return std::nullopt;
  const auto json = read_json(file);
  std::vector<double> rows;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column)
      rows.push_back(number_at(json, fmt::format("t_{}{}", row, column), file));
  }
  const auto T = rigid_motion(*matrix_of(rows));
  return T ? std::optional(from_arkit(*T)) : std::nullopt;
}

PinholeCamera polycam_lens(const nlohmann::json& json, const fs::path& file) {
  const auto number = [&](const char* key) { return number_at(json, key, file); };
  return make_lens(checked_size(number("width"), number("height"), file), number("fx"), number("fy"),
                   number("cx"), number("cy"));
}

RecordedSequence read_polycam(const fs::path& folder) {
  constexpr double kMicrosecond = 1e-6, kAnyRate_hz = 30;
  const fs::path keyframes = keyframes_of(folder);
  RecordedSequence sequence;
  sequence.layout = "Polycam folder";
  sequence.frames = pair_by_number(numbered_files(keyframes / "images", "", ".jpg"),
                                   numbered_files(keyframes / "depth", "", ".png"), kAnyRate_hz);
  std::error_code absent;
  const bool corrected = fs::is_directory(keyframes / "corrected_cameras", absent);
  std::vector<PinholeCamera> lenses;
  for (RecordedFrame& frame : sequence.frames) {
    const std::string stem = frame.color.file.stem().string();
    const fs::path file = keyframes / "cameras" / (stem + ".json");
    const auto json = read_json(file);
    lenses.push_back(polycam_lens(json, file));
    frame.stamp_ns = frame.depth_stamp_ns =
        checked_stamp(kMicrosecond * number_at(json, "timestamp", file), file);
    const fs::path confidence = keyframes / "confidence" / (stem + ".png");
    if (fs::exists(confidence, absent)) frame.confidence = confidence;
    const auto T = polycam_pose(corrected ? keyframes / "corrected_cameras" / (stem + ".json") : file);
    if (T) sequence.ground_truth.push_back({frame.stamp_ns, *T});
  }
  finish_phone_sequence(sequence, lenses, keyframes);
  return sequence;
}

}  // namespace

SequenceLayout polycam_layout() {
  return {"Polycam", "keyframes/ with images/, depth/ and cameras/", polycam_evidence, read_polycam};
}

}  // namespace kinloop
