// ETH3D SLAM (Schoeps et al. 2019), and other folders in TUM layout with a calibration.txt: "fx fy cx cy" and
// perhaps k1 k2 p1 p2 k3.

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

std::string eth3d_evidence(const std::filesystem::path& folder, const FolderContents& contents) {
  const bool fits = contents.has_file("calibration.txt") && has_tum_lists(folder);
  return fits ? "rgb.txt, depth.txt, calibration.txt" : "";
}

PinholeCamera read_calibration(const std::filesystem::path& file, cv::Size size) {
  constexpr size_t kPinhole = 4, kWithDistortion = 8, kWithK3 = 9;
  const auto v = read_numbers(file);
  if (v.size() != kPinhole && v.size() != kWithDistortion && v.size() != kWithK3) {
    throw InputError(
        fmt::format("{}: {} numbers where 'fx fy cx cy' and perhaps 'k1 k2 p1 p2 [k3]' are "
                    "expected; correct it",
                    file.string(), v.size()));
  }
  PinholeCamera lens = make_lens(size, v[0], v[1], v[2], v[3]);
  if (v.size() >= kWithDistortion) lens.lens = {LensModel::kBrownConrady, v[4], v[5], v[6], v[7]};
  if (v.size() == kWithK3) lens.lens.k3 = v[8];
  return checked_lens(lens, file);
}

RecordedSequence read_eth3d(const std::filesystem::path& folder) {
  RecordedSequence sequence = read_tum(folder);
  sequence.layout = "ETH3D folder";
  RgbdCamera camera;
  camera.color =
      read_calibration(folder / "calibration.txt", image_size(sequence.frames, &RecordedFrame::color));
  camera.fps = median_rate_hz(sequence.frames, camera.fps);
  sequence.camera = camera;
  return sequence;
}

}  // namespace

SequenceLayout eth3d_layout() {
  return {"ETH3D", "rgb.txt, depth.txt and calibration.txt", eth3d_evidence, read_eth3d};
}

}  // namespace kinloop
