#include "kinloop/optimize/pose/moving_pose.hpp"

#include "kinloop/optimize/pose/camera_observations.hpp"
#include "kinloop/optimize/pose/pose_minimizer.hpp"

namespace kinloop {
namespace {

/// The normal equations of the measurements and the prior. That the velocity changes with the pose is left
/// out of the derivatives: it moves the pixels by far less than the pose does.
PoseNormal<6> linearize(const SE3& T_world_camera, const CameraObservations& observations,
                        const Sensor& sensor, const MotionPrior& prior) {
  static const LinearColumns kColumns = LinearColumns::of_pose();
  const auto observed =
      observations.linearize({T_world_camera, prior.velocity_at(T_world_camera)}, sensor, kColumns);
  const Vector6d x = prior.deviation(T_world_camera);
  PoseNormal<6> normal;
  normal.H = observed.gram.topLeftCorner<6, 6>().selfadjointView<Eigen::Upper>();
  normal.H += prior.information;
  normal.g = observed.gram.col(LinearColumns::kResidual).head<6>() + prior.information * x;
  normal.cost = observed.cost + x.dot(prior.information * x);
  return normal;
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
  const CameraObservations all = observations_of(observations);
  CameraObservations used = all;
  SE3 T = guess;
  const auto classify = [&] { return used.classify({T, prior.velocity_at(T)}, sensor); };
  classify();
  if (used.inlier_count() < options.min_inliers) used = all;  // the guess is far off
  for (int round = 0; round < kRounds; ++round) {
    T = minimize_pose<6>(
        T, options.max_iterations, [&](const SE3& at) { return linearize(at, used, sensor, prior); },
        [](const SE3& at, const Vector6d& step) { return at * SE3::exp(step); });
    const bool changed = classify();
    if (used.inlier_count() < options.min_inliers) return std::nullopt;
    if (!changed) break;
  }
  return RollingShutterPose{T, prior.velocity_at(T)};
}

}  // namespace kinloop
