#include "kinloop/tracking/motion_model.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

bool exceeds_hand_motion(double off_m, double interval_s, double baseline_s) {
  // One pose that is 5 cm off is 10 cm off the line of its neighbours.
  constexpr double kTolerance_m = 0.1;
  return off_m > kTolerance_m + kMaxAcceleration_m_s2 * interval_s * std::max(interval_s, baseline_s);
}

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
}

PredictedPose MotionModel::predict(int64_t duration_ns) const {
  const double duration_s = to_seconds(duration_ns);
  if (!velocity_) return {{}, kDefaultSpeed_m_s * duration_s, kDefaultTurnRate_rad_s * duration_s};
  return {SE3::exp(velocity_->vector() * std::min(duration_s, kMaxExtrapolation_s)),
          std::sqrt(acceleration_noise_.translation * duration_s) * duration_s,
          std::sqrt(acceleration_noise_.rotation * duration_s) * duration_s};
}

}  // namespace kinloop
