#pragma once
// Landmarks vote on a pose in order of age: those that several keyframes have seen at one place decide, and
// the new ones follow if they agree. A thing that moves through the view yields many new landmarks that agree
// with each other, but not with the map.

#include "kinloop/optimize/pose/absolute_pose.hpp"

namespace kinloop {

/// Fewer confirmed landmarks do not decide alone.
inline constexpr int kMinConfirmed = 30;

/// Smallest share of the landmarks tried that agree with an accepted pose.
inline constexpr double kMinConsistent = 0.7;

/// A pose with the number of observations that it had to explain.
struct VotedPose : AbsolutePoseSolution {
  int voters = 0;
};

/// Like solve_absolute_pose, but by the `confirmed` observations alone if most of the others contradict them;
/// those are outliers then.
std::optional<VotedPose> solve_by_confirmed_first(const Sensor& sensor,
                                                  std::span<const PoseObservation> observations,
                                                  const std::vector<bool>& confirmed,
                                                  const SE3& T_reference_camera_guess,
                                                  const AbsolutePoseOptions& options);

}  // namespace kinloop
