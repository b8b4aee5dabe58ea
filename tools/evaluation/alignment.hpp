#pragma once
// In: matched camera poses of two trajectories. Out: the motion that takes one world onto the other.

#include <optional>
#include <span>
#include <string_view>

#include "kinloop/core/options.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Which motions of the estimate's world an alignment may choose from.
enum class Alignment {
  kSe3,   ///< rigid: rotation and translation
  kSim3,  ///< rigid, and one scale
  kYaw,   ///< rotation about the z axis of the truth, which is vertical, and translation
  kNone   ///< none: both trajectories are in one world
};

constexpr auto option_names(Alignment) {
  using enum Alignment;
  return std::to_array<EnumName<Alignment>>({{kSe3, "se3"}, {kSim3, "sim3"}, {kYaw, "yaw"}, {kNone, "none"}});
}

/// x -> scale * rotation * x + translation.
struct Similarity {
  double scale = 1;
  SE3 T;

  /// Moves a camera: its centre is scaled, its rotation is not.
  [[nodiscard]] SE3 moved(const SE3& T_b_camera) const {
    return {T.rotation * T_b_camera.rotation, scale * (T.rotation * T_b_camera.translation) + T.translation};
  }
};

/// Returns the S_a_b that minimises the sum of |a_i - S_a_b b_i|^2 over the camera centres (Umeyama 1991).
/// Centres on a line, or all in one place, leave a rotation free; the one that fits the orientations best is
/// taken. nullopt for fewer than three pairs, or if the scale is asked for and b has no extent.
std::optional<Similarity> align_poses(std::span<const SE3> a, std::span<const SE3> b, Alignment alignment);

}  // namespace kinloop
