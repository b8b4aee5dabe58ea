#include "drivers/datasets/reading/two_lenses.hpp"

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {

RgbdCamera camera_of(const TwoLenses& lenses, double depth_scale, const std::filesystem::path& file) {
  constexpr double kSame_m = 1e-6, kLeast = 1e-2, kMost = 1e6;
  if (!(depth_scale >= kLeast && depth_scale <= kMost)) {
    throw InputError(
        fmt::format("{}: a depth scale of {} units per metre; copy it again", file.string(), depth_scale));
  }
  RgbdCamera camera;
  camera.color = lenses.color;
  camera.depth_scale = depth_scale;
  const SE3 T_color_depth = lenses.T_body_color.inverse() * lenses.T_body_depth;
  const bool registered = lenses.color == lenses.depth && T_color_depth.translation.norm() < kSame_m &&
                          T_color_depth.angle_rad() < kSame_m;
  if (registered) return camera;
  camera.depth = lenses.depth;
  camera.T_color_depth = T_color_depth;
  return camera;
}

void move_to_color(const TwoLenses& lenses, Trajectory& trajectory) {
  for (StampedPose& pose : trajectory) pose.T_world_camera = pose.T_world_camera * lenses.T_body_color;
}

}  // namespace kinloop
