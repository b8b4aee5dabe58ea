// ScanNet (Dai et al. 2017) as its reader exports it: color/0.jpg, depth/0.png in millimetres, pose/0.txt,
// intrinsic/{intrinsic,extrinsic}_{color,depth}.txt. Depth has another size and lens than colour.

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/datasets/reading/two_lenses.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr double kScanNetRate_hz = 30, kScanNetUnits = 1000;

std::string scannet_evidence(const fs::path&, const FolderContents& c) {
  const bool exported =
      c.has_folder("color") && c.has_folder("depth") && c.has_folder("pose") && c.has_folder("intrinsic");
  return exported ? "color/ depth/ pose/ intrinsic/" : "";
}

/// Absent or not rigid: the cameras are at the same place.
SE3 read_extrinsic(const fs::path& file) {
  std::error_code absent;
  if (!fs::exists(file, absent)) return {};
  return rigid_motion(read_matrix(file)).value_or(SE3{});
}

RecordedSequence read_scannet(const fs::path& folder) {
  RecordedSequence sequence;
  sequence.layout = "ScanNet folder";
  sequence.stamps_measured = false;
  auto color = numbered_files(folder / "color", "", ".jpg");
  if (color.empty()) color = numbered_files(folder / "color", "", ".png");
  if (color.empty())
    throw InputError(fmt::format("{}: no colour images; copy them", (folder / "color").string()));
  sequence.frames = pair_by_number(color, numbered_files(folder / "depth", "", ".png"), kScanNetRate_hz);
  const fs::path calibration = folder / "intrinsic";
  const TwoLenses lenses{
      read_lens(calibration / "intrinsic_color.txt", image_size(sequence.frames, &RecordedFrame::color)),
      read_lens(calibration / "intrinsic_depth.txt", image_size(sequence.frames, &RecordedFrame::depth)),
      read_extrinsic(calibration / "extrinsic_color.txt"),
      read_extrinsic(calibration / "extrinsic_depth.txt")};
  sequence.camera = camera_of(lenses, kScanNetUnits, folder);
  sequence.sensor = DepthSensorModel::kStructuredLight;  // a Structure Sensor
  sequence.ground_truth = truth_of(sequence.frames, [&](const RecordedFrame& frame, size_t) {
    const fs::path file = folder / "pose" / (frame.color.file.stem().string() + ".txt");
    std::error_code absent;
    return fs::exists(file, absent) ? rigid_motion(read_matrix(file)) : std::nullopt;
  });
  move_to_color(lenses, sequence.ground_truth);
  return sequence;
}

}  // namespace

SequenceLayout scannet_layout() {
  return {"ScanNet", "color/, depth/, pose/ and intrinsic/", scannet_evidence, read_scannet};
}

}  // namespace kinloop
