#include "kinloop/optimize/pose/moving_pose.hpp"

#include "kinloop/optimize/pose/camera_observations.hpp"

namespace kinloop {
namespace {

/// The normal equations of the measurements and the prior. That the velocity changes with the pose is left
/// out of the derivatives: it moves the pixels by far less than the pose does.
PoseNormal<6> linearize(const SE3& T_world_camera, const CameraObservations& observations,
                        const Sensor& sensor, const MotionPrior& prior) {
  const BundleView view{T_world_camera, prior.velocity_at(T_world_camera)};
  return with_prior(observations.linearize_pose(view, sensor), {prior.mean.T_world_camera, prior.information},
                    T_world_camera);
}

}  // namespace

Vector6d MotionPrior::deviation(const SE3& T_world_camera) const {
  return (mean.T_world_camera.inverse() * T_world_camera).log();
}

Velocity MotionPrior::velocity_at(const SE3& T_world_camera) const {
  return Velocity::from_vector(mean.velocity.vector() + velocity_gain * deviation(T_world_camera));
}

std::optional<RollingShutterPose> solve_moving_pose(const Sensor& sensor,
                                                    std::span<const PoseObservation> observations,
                                                    const SE3& guess, const MotionPrior& prior,
                                                    const AbsolutePoseOptions& options) {
  constexpr int kRounds = 2;  // the outliers are known from the solution without a prior
  CameraObservations used = observations_of(observations);
  SE3 T = guess;
  used.classify_guess({T, prior.velocity_at(T)}, sensor, options.min_inliers);
  for (int round = 0; round < kRounds; ++round) {
    T = minimize_pose<6>(
        T, options.max_iterations, [&](const SE3& at) { return linearize(at, used, sensor, prior); },
        [](const SE3& at, const Vector6d& step) { return at * SE3::exp(step); });
    const bool changed = used.classify({T, prior.velocity_at(T)}, sensor);
    if (used.inlier_count() < options.min_inliers) return std::nullopt;
    if (!changed) break;
  }
  return RollingShutterPose{T, prior.velocity_at(T)};
}

}  // namespace kinloop
