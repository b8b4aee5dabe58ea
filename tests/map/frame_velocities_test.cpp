#include "kinloop/map/frames/frame_velocities.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

constexpr double kSwing_m = 0.2, kSwing_rad = 0.15, kRate_rad_s = 2 * 3.14159 / 1.7;

/// A camera that oscillates along x and about y.
SE3 swinging(double at_s) {
  const double phase = kRate_rad_s * at_s;
  return {exp_so3({0, kSwing_rad * std::cos(phase), 0}), {kSwing_m * std::sin(phase), 0, 0}};
}

struct Recorded {
  Map map;
  FrameLog log;
};

/// Its frames at a constant rate, with poses relative to a keyframe at the origin.
Recorded recorded_swing(double frames_per_s, int count = 60) {
  Recorded recorded;
  recorded.map.add_keyframe(FrameId{0}, 0, {}, std::make_shared<const Features>(), 0);
  for (int i = 0; i < count; ++i) {
    LoggedFrame entry;
    entry.id = FrameId{static_cast<uint32_t>(i)};
    entry.stamp_ns = to_ns(i / frames_per_s);
    entry.outcome = TrackingOutcome::kTracked;
    entry.reference = KeyframeId{0};
    entry.T_reference_camera = swinging(to_seconds(entry.stamp_ns));
    recorded.log.push_back(entry);
  }
  return recorded;
}

/// Root mean square error of the x velocity in the world frame, m/s.
double shift_error_m_s(const Recorded& recorded) {
  const auto velocities = frame_velocities(recorded.log, recorded.map);
  double squares = 0;
  EXPECT_EQ(velocities.size(), recorded.log.size());
  EXPECT_GT(velocities.size(), 10U);
  for (size_t i = 1; i + 1 < velocities.size(); ++i) {
    const SE3 T_world_camera = recorded.log[i].world(recorded.map);
    const double truth =
        kSwing_m * kRate_rad_s * std::cos(kRate_rad_s * to_seconds(recorded.log[i].stamp_ns));
    squares += std::pow((T_world_camera.R() * velocities[i].linear_m_s).x() - truth, 2);
  }
  return std::sqrt(squares / static_cast<double>(velocities.size() - 2));
}

TEST(FrameVelocities, AreEstimatedAtEightFramesPerSecond) {
  const double speed_m_s = kSwing_m * kRate_rad_s / std::sqrt(2.0);
  EXPECT_LT(shift_error_m_s(recorded_swing(30)), 0.004 * speed_m_s);
  EXPECT_LT(shift_error_m_s(recorded_swing(8)), 0.05 * speed_m_s);
}

TEST(FrameVelocities, AreZeroAfterALongGap) {
  const Recorded recorded = recorded_swing(1);
  const auto velocities = frame_velocities(recorded.log, recorded.map);
  ASSERT_EQ(velocities.size(), recorded.log.size());
  ASSERT_GT(velocities.size(), 2U);
  for (const Velocity& velocity : velocities) {
    EXPECT_TRUE(velocity.vector().isZero(0));
  }
}

}  // namespace
}  // namespace kinloop
