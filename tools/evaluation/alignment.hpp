#pragma once
// In: two trajectories in one clock. Out: which poses are compared, and the motion that takes one world onto
// the other.

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "kinloop/core/association.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// Whose figures an evaluation reproduces.
enum class Convention {
  kTum,  ///< the tools of the TUM RGB-D benchmark: closest pairs first, each pose once
  kEvo  ///< evo_ape and evo_rpe --all_pairs: for each pose of the shorter trajectory the closest of the other
};

constexpr auto option_names(Convention) {
  using enum Convention;
  return std::to_array<EnumName<Convention>>({{kTum, "tum"}, {kEvo, "evo"}});
}

/// Seconds as tools in Python store them: a double resolves 0.24 us of Unix time. Stamps of four decimals
/// often lie exactly midway between two others, where the choice depends on this rounding.
double rounded_seconds(int64_t stamp_ns);

/// Returns the pairs (a: truth, b: estimate) that are at most `max_difference_ns` apart, sorted by time.
std::vector<StampPair> pair_poses(const Trajectory& estimate, const Trajectory& truth,
                                  int64_t max_difference_ns, Convention convention);

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
