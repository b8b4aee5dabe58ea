#include "kinloop/tracking/motion/motion_model.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "kinloop/belief/hand_motion.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

// A pose is compensated for readout and delay (up to 30 ms) by the velocity before it, so an error of that
// velocity comes back in the next one, multiplied by the ratio of that time to the interval of the frames. At
// 60 Hz the velocity would swing up by itself unless it is averaged.
constexpr int64_t kVelocityBaseline_ns = 30'000'000;
constexpr double kMaxExtrapolation_s = 0.25;  // hand motion reverses within a few tenths of a second
constexpr double kSmoothing = 0.9;  // weight of the previous acceleration noise against that of the new frame
constexpr double kDefaultSpeed_m_s = 0.5;  // 1 sigma of a handheld camera of unknown motion
constexpr double kDefaultTurnRate_rad_s = 1.0;
constexpr double kMaxAcceleration_m_s2 = 10;  // of a hand that holds a camera

// Of the prior, learned on the simulated rooms 101 to 105 (docs/lab/measurements.md#the-motion-before).
// The landmarks of two frames are not the same, and have been adjusted in between (1 sigma).
constexpr double kMapNoise_m = 1e-3, kMapNoise_rad = 5e-4;
// The frames share the errors of their landmarks, so that a pose is less certain than its keypoints say.
constexpr double kVarianceOfPoses = 10;  // times that of the keypoints

/// Returns `value`, no farther than `max_change` from `before`.
Eigen::Vector3d limited(const Eigen::Vector3d& value, const Eigen::Vector3d& before, double max_change) {
  const Eigen::Vector3d change = value - before;
  return change.norm() > max_change ? before + max_change * change.normalized() : value;
}

/// Returns the velocity after `before`, no farther from it than a hand accelerates a camera in `duration_s`.
Velocity limited(const Velocity& velocity, const Velocity& before, double duration_s) {
  constexpr double kTolerance_m = 0.02;
  constexpr double kTolerance_rad = 0.02, kMaxAcceleration_rad_s2 = 30;
  return {limited(velocity.linear_m_s, before.linear_m_s,
                  kTolerance_m / duration_s + kMaxAcceleration_m_s2 * duration_s),
          limited(velocity.angular_rad_s, before.angular_rad_s,
                  kTolerance_rad / duration_s + kMaxAcceleration_rad_s2 * duration_s)};
}

Vector6d per_axis(double translation, double rotation) {
  return (Vector6d() << Eigen::Vector3d::Constant(translation), Eigen::Vector3d::Constant(rotation))
      .finished();
}

}  // namespace

Velocity MotionModel::velocity_of(const SE3& T_previous_current, int64_t duration_ns) const {
  if (duration_ns < kMinVelocityInterval_ns) return velocity();
  const double duration_s = to_seconds(duration_ns);
  Velocity measured = velocity_of_twist(T_previous_current.log(), duration_s);
  if (!velocity_) return measured;
  measured = limited(measured, *velocity_, duration_s);
  if (duration_ns >= kVelocityBaseline_ns) return measured;
  const double share = static_cast<double>(duration_ns) / static_cast<double>(kVelocityBaseline_ns);
  return Velocity::from_vector(share * measured.vector() + (1 - share) * velocity_->vector());
}

void MotionModel::update(const Velocity& velocity, int64_t duration_ns) {
  if (duration_ns < kMinVelocityInterval_ns) return;
  const double duration_s = to_seconds(duration_ns);
  if (velocity_) {
    const auto filtered = [&](double so_far, const Eigen::Vector3d& axes) {
      return kSmoothing * so_far + (1 - kSmoothing) * axes.squaredNorm() / (3 * duration_s);
    };
    acceleration_noise_.translation =
        filtered(acceleration_noise_.translation, velocity.linear_m_s - velocity_->linear_m_s);
    acceleration_noise_.rotation =
        filtered(acceleration_noise_.rotation, velocity.angular_rad_s - velocity_->angular_rad_s);
  }
  velocity_ = velocity;
  covariance_ = unknown_velocity();
}

void MotionModel::update(const Velocity& velocity, int64_t duration_ns, const Matrix6d& pose_covariance) {
  const MotionCovariance predicted = predicted_covariance(to_seconds(duration_ns));
  const auto of_pose = predicted.leftCols<6>();
  const Matrix6d innovation = of_pose.topRows<6>() + kVarianceOfPoses * pose_covariance;
  update(velocity, duration_ns);
  covariance_ = predicted - of_pose * innovation.ldlt().solve(of_pose.transpose());
}

void MotionModel::reset() {
  velocity_.reset();
  covariance_ = unknown_velocity();
}

MotionModel::MotionCovariance MotionModel::unknown_velocity() {
  MotionCovariance covariance = MotionCovariance::Zero();
  covariance.diagonal() << per_axis(kMapNoise_m, kMapNoise_rad).cwiseAbs2(),
      per_axis(kDefaultSpeed_m_s, kDefaultTurnRate_rad_s).cwiseAbs2();
  return covariance;
}

/// The covariance after a time in which the acceleration is white noise.
MotionModel::MotionCovariance MotionModel::predicted_covariance(double duration_s) const {
  MotionCovariance transition = MotionCovariance::Identity();
  transition.topLeftCorner<6, 6>() = SE3::exp(-duration_s * velocity().vector()).adjoint();
  transition.topRightCorner<6, 6>().diagonal().setConstant(duration_s);
  MotionCovariance covariance = transition * covariance_ * transition.transpose();
  const Vector6d walk = hand_acceleration_noise();
  covariance.diagonal().head<6>() +=
      hand_motion_covariance(duration_s, 0).diagonal() + per_axis(kMapNoise_m, kMapNoise_rad).cwiseAbs2();
  covariance.topRightCorner<6, 6>().diagonal() += duration_s * duration_s / 2 * walk;
  covariance.bottomLeftCorner<6, 6>().diagonal() += duration_s * duration_s / 2 * walk;
  covariance.diagonal().tail<6>() += duration_s * walk;
  return covariance;
}

bool MotionModel::agrees(const MotionPrior& prior, const SE3& T_reference_camera,
                         const Matrix6d& pose_covariance) {
  constexpr double kMaxSquare = 33.1;  // one in 10^5 is larger: chi-square with six degrees of freedom
  const Matrix6d of_prior = prior.information.ldlt().solve(Matrix6d::Identity());
  // As the information of the prior, relative to the noise that the pose states of itself.
  const Matrix6d relative = of_prior + pose_covariance;
  const Vector6d off = prior.deviation(T_reference_camera);
  return off.dot(relative.ldlt().solve(off)) <= kVarianceOfPoses * kMaxSquare;
}

std::optional<MotionPrior> MotionModel::prior(const SE3& T_reference_previous, int64_t duration_ns) const {
  constexpr int64_t kMaxDuration_ns = 150'000'000;  // hand motion is smooth for as long
  if (duration_ns < kMinVelocityInterval_ns || duration_ns > kMaxDuration_ns) return std::nullopt;
  const double duration_s = to_seconds(duration_ns);
  const MotionCovariance covariance = predicted_covariance(duration_s);
  const Matrix6d information = covariance.topLeftCorner<6, 6>().ldlt().solve(Matrix6d::Identity());
  return MotionPrior{{T_reference_previous * SE3::exp(duration_s * velocity().vector()), velocity()},
                     kVarianceOfPoses * information,
                     covariance.bottomLeftCorner<6, 6>() * information};
}

PredictedPose MotionModel::predict(int64_t duration_ns) const {
  const double duration_s = to_seconds(duration_ns);
  if (!velocity_) return {{}, kDefaultSpeed_m_s * duration_s, kDefaultTurnRate_rad_s * duration_s};
  return {SE3::exp(velocity_->vector() * std::min(duration_s, kMaxExtrapolation_s)),
          std::sqrt(acceleration_noise_.translation * duration_s) * duration_s,
          std::sqrt(acceleration_noise_.rotation * duration_s) * duration_s};
}

}  // namespace kinloop
