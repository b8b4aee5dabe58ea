#pragma once
// In: poses with covariances, and ground truth. Out: whether the errors are consistent with the covariances.

#include <optional>
#include <span>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// A pose relative to the reference pose, with the covariance of x = (translation; rotation), m and rad,
/// where the true pose is T_world_camera * exp(x).
struct PoseWithCovariance {
  int64_t stamp_ns = 0;
  SE3 T_world_camera;
  Matrix6d covariance = Matrix6d::Zero();
};

/// Returns the poses without their covariances.
Trajectory trajectory_of(std::span<const PoseWithCovariance> poses);

/// Normalised estimation error squared (Bar-Shalom et al. 2001, section 5.4), averaged over poses: 3 each if
/// the covariances are right, more if they are too small.
struct Consistency {
  size_t poses = 0;
  double nees_translation = 0;
  double nees_rotation = 0;
  /// Share of the poses whose errors of translation and rotation are both within four standard deviations
  /// along the least certain direction of each; 0.999 for errors normally distributed.
  double within_4_sigma = 0;
};

/// `poses[0]` is the reference of the covariances. nullopt if it or all others lack ground truth or a
/// covariance of full rank.
std::optional<Consistency> evaluate_consistency(const std::vector<PoseWithCovariance>& poses,
                                                const Trajectory& truth);

}  // namespace kinloop
