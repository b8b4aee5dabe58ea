#pragma once
// Where the camera will be, if it goes on as it went, and how far from there it may be.

#include <cstdint>
#include <optional>

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// A pose expected, and how far it may be off along and around each axis (1 sigma).
struct PredictedPose {
  SE3 T;
  double sigma_m = 0;
  double sigma_rad = 0;
};

/// Constant velocity in the camera's own frame, disturbed by accelerations as large as the last ones were.
class MotionModel {
 public:
  /// Learns from the motion between two frames that were tracked one after the other.
  void update(const SE3& T_previous_current, int64_t duration_ns);

  /// Forgets the velocity: after a loss nothing is known.
  void reset() { velocity_per_s_.reset(); }

  /// Motion T_previous_current expected over `duration_ns`; identity where the velocity is unknown. Over a
  /// long gap the hand has surely turned back, so the velocity is carried on for a short time only.
  [[nodiscard]] PredictedPose predict(int64_t duration_ns) const;

  /// Rate of motion in the camera's axes, m/s and rad/s; zero where it is unknown.
  [[nodiscard]] Vector6d velocity() const { return velocity_per_s_.value_or(Vector6d::Zero()); }

 private:
  /// How the velocity changes, as a random walk: growth of its variance a second, per axis.
  struct AccelerationNoise {
    double translation = 0.1;  // (m/s)^2 / s: a hand that is neither calm nor hasty
    double rotation = 1.0;     // (rad/s)^2 / s
  };

  std::optional<Vector6d> velocity_per_s_;  // twist, m/s and rad/s
  AccelerationNoise acceleration_noise_;
};

}  // namespace kinloop
