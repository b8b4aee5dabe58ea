// TartanAir (Wang et al. 2020): image_left/000000_left.png, depth_left/000000_left_depth.npy in metres, and
// pose_left.txt with a pose "tx ty tz qx qy qz qw" per frame, whose camera has x forward, y right, z down
// (NED). One simulated camera for all sequences.

#include <fmt/format.h>

#include "drivers/datasets/layouts/layouts.hpp"
#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

std::string tartan_air_evidence(const fs::path&, const FolderContents& contents) {
  return contents.has_folder("image_left") && contents.has_folder("depth_left") ? "image_left/ depth_left/"
                                                                                : "";
}

/// The pose of our camera: its x (right) is NED's y, its y (down) NED's z, its z (forward) NED's x.
SE3 from_ned(const SE3& T_world_ned) {
  Eigen::Matrix3d R_ned_camera;
  R_ned_camera << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return T_world_ned * SE3{Eigen::Quaterniond(R_ned_camera), Eigen::Vector3d::Zero()};
}

RecordedSequence read_tartan_air(const fs::path& folder) {
  constexpr double kRate_hz = 30;  // the dataset has no times
  constexpr size_t kPose = 7;
  RecordedSequence sequence;
  sequence.layout = "TartanAir folder";
  sequence.stamps_measured = false;
  sequence.depth_encoding = DepthEncoding::kFloatImage;
  RgbdCamera camera;
  camera.color = make_lens({640, 480}, 320, 320, 320, 240);
  camera.depth_scale = 1;
  camera.fps = kRate_hz;
  sequence.camera = camera;
  sequence.frames = pair_by_number(numbered_files(folder / "image_left", "", "_left.png"),
                                   numbered_files(folder / "depth_left", "", "_left_depth.npy"), kRate_hz);
  const fs::path file = folder / "pose_left.txt";
  std::error_code absent;
  if (!fs::exists(file, absent)) return sequence;
  const auto v = read_numbers(file);
  if (v.size() % kPose != 0)
    throw InputError(
        fmt::format("{}: {} numbers, where each line has {}; copy it again", file.string(), v.size(), kPose));
  sequence.ground_truth =
      truth_of(sequence.frames, [&](const RecordedFrame& frame, size_t) -> std::optional<SE3> {
        const auto number = numbered_name(frame.color.file, "", "_left.png");
        if (!number || *number >= v.size() / kPose) return std::nullopt;
        const auto T_world_ned = motion_of(std::span(v).subspan(*number * kPose, kPose));
        return T_world_ned ? std::optional(from_ned(*T_world_ned)) : std::nullopt;
      });
  return sequence;
}

}  // namespace

SequenceLayout tartan_air_layout() {
  return {"TartanAir", "image_left/, depth_left/ and pose_left.txt", tartan_air_evidence, read_tartan_air};
}

}  // namespace kinloop
