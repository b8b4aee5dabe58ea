#pragma once
// Where the camera will be, if it goes on as it went.

#include <cstdint>
#include <optional>

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Constant velocity in the camera's own frame.
class MotionModel {
 public:
  /// Learns from the motion between two frames that were tracked one after the other.
  void update(const SE3& T_previous_current, int64_t duration_ns);

  /// Forgets the velocity: after a loss nothing is known.
  void reset() { velocity_per_s_.reset(); }

  /// Motion expected over `duration_ns`; identity where the velocity is unknown. Over a long gap the hand has
  /// surely turned back, so the velocity is carried on for a short time only.
  [[nodiscard]] SE3 predict(int64_t duration_ns) const;

  /// Rate of motion in the camera's axes, m/s and rad/s; zero where it is unknown.
  [[nodiscard]] Vector6d velocity() const { return velocity_per_s_.value_or(Vector6d::Zero()); }

 private:
  std::optional<Vector6d> velocity_per_s_;  // twist, m/s and rad/s
};

}  // namespace kinloop
