#pragma once
// In: poses with covariances, and ground truth. Out: whether the errors are as large as the covariances say.

#include <optional>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// A pose relative to the first of its kind, with the covariance of x = (translation; rotation), m and rad,
/// where the true pose is T_world_camera * exp(x).
struct PoseWithCovariance {
  int64_t stamp_ns = 0;
  SE3 T_world_camera;
  Matrix6d covariance = Matrix6d::Zero();
};

/// Normalised estimation error squared (Bar-Shalom et al. 2001, section 5.4), averaged over poses: 3 each
/// where the covariances are right, more where they promise too much.
struct Consistency {
  size_t poses = 0;
  double nees_translation = 0;
  double nees_rotation = 0;
};

/// `poses[0]` is the one that the covariances refer to. Nothing where it or all others have no ground truth,
/// or no covariance of full rank.
std::optional<Consistency> evaluate_consistency(const std::vector<PoseWithCovariance>& poses,
                                                const Trajectory& truth);

}  // namespace kinloop
