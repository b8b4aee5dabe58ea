#pragma once
// Prediction of the camera pose with its uncertainty. In the direction that the landmarks of a frame leave
// open the motion before decides, as in a Kalman filter whose acceleration is white noise.

#include <cstdint>
#include <optional>

#include "kinloop/geometry/velocity.hpp"
#include "kinloop/optimize/pose/moving_pose.hpp"

namespace kinloop {

/// A predicted pose and its uncertainty along and around each axis (1 sigma).
struct PredictedPose {
  SE3 T;
  double sigma_m = 0;
  double sigma_rad = 0;
};

/// Constant velocity in the camera frame, with acceleration noise estimated from recent motion.
class MotionModel {
 public:
  /// Returns the velocity of a motion between two consecutive frames; the present one if they are too close
  /// in time. Where it differs from the present one by more than a hand accelerates a camera, one of the two
  /// poses is wrong, and compensation by that velocity would make the next one wrong as well: it is changed
  /// only as far as a hand could.
  [[nodiscard]] Velocity velocity_of(const SE3& T_previous_current, int64_t duration_ns) const;

  /// Updates the model with the velocity of a frame, `duration_ns` after the previous one.
  void update(const Velocity& velocity, int64_t duration_ns);

  /// The same for a frame whose pose landmarks determine with `pose_covariance`.
  void update(const Velocity& velocity, int64_t duration_ns, const Matrix6d& pose_covariance);

  /// Returns what the motion up to the previous frame, at `T_reference_previous`, says of the frame
  /// `duration_ns` later; nullopt if that is too short or too long a time.
  [[nodiscard]] std::optional<MotionPrior> prior(const SE3& T_reference_previous, int64_t duration_ns) const;

  /// Returns whether a pose that landmarks determine with `pose_covariance` may follow from the motion
  /// before: not where the camera or the map has jumped.
  [[nodiscard]] static bool agrees(const MotionPrior& prior, const SE3& T_reference_camera,
                                   const Matrix6d& pose_covariance);

  /// Resets the velocity to unknown, after tracking loss.
  void reset();

  /// Predicts the motion T_previous_current over `duration_ns`; identity if the velocity is unknown. The
  /// velocity is extrapolated for a short time only, since hand motion reverses within a longer gap.
  [[nodiscard]] PredictedPose predict(int64_t duration_ns) const;

  /// Velocity of the last frame; zero if unknown.
  [[nodiscard]] Velocity velocity() const { return velocity_.value_or(Velocity{}); }
  [[nodiscard]] bool knows_velocity() const { return velocity_.has_value(); }

 private:
  /// Random walk of the velocity: growth of its variance per second, per axis.
  struct AccelerationNoise {
    double translation = 0.1;  // (m/s)^2 / s: typical for handheld motion
    double rotation = 1.0;     // (rad/s)^2 / s
  };

  /// Covariance of (pose; velocity) of a frame.
  using MotionCovariance = Eigen::Matrix<double, 12, 12>;

  [[nodiscard]] static MotionCovariance unknown_velocity();
  [[nodiscard]] MotionCovariance predicted_covariance(double duration_s) const;

  std::optional<Velocity> velocity_;  // constant twist
  AccelerationNoise acceleration_noise_;
  MotionCovariance covariance_ = unknown_velocity();
};

}  // namespace kinloop
