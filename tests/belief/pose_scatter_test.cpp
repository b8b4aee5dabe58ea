#include "kinloop/belief/pose_scatter.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

constexpr double kNoise_m = 1e-3, kNoise_rad = 2e-3, kKeyframeFactor = 3;
constexpr int kFrames = 600, kKeyframeInterval = 10;

/// A camera that moves at 0.3 m/s and turns at 0.4 rad/s.
SE3 steady(double at_s) {
  return {exp_so3({0, 0.4 * at_s, 0}), {0.3 * at_s, 0, 0}};
}

SE3 noise(Random& random, double factor) {
  Vector6d x;
  for (int i = 0; i < 6; ++i) x(i) = factor * (i < 3 ? kNoise_m : kNoise_rad) * random.gaussian();
  return SE3::exp(x);
}

/// Frames of that camera with independent errors; those of keyframes are larger.
FrameLog noisy_log(Map& map) {
  Random random(4);
  const KeyframeId origin = map.add_keyframe(FrameId{0}, 0, {}, std::make_shared<const Features>(), 0);
  FrameLog log(kFrames);
  for (int i = 0; i < kFrames; ++i) {
    LoggedFrame& entry = log[static_cast<size_t>(i)];
    entry.stamp_ns = to_ns(i / 30.0);
    entry.outcome = TrackingOutcome::kTracked;
    entry.reference = origin;
    const bool keyframe = i % kKeyframeInterval == 0;
    if (keyframe) entry.keyframe = KeyframeId{static_cast<uint32_t>(i / kKeyframeInterval)};
    entry.T_reference_camera = steady(i / 30.0) * noise(random, keyframe ? kKeyframeFactor : 1);
  }
  return log;
}

/// Mean standard deviations in m and rad over the frames that are keyframes or not.
Eigen::Vector2d mean_sigma(const FrameLog& log, const std::vector<Matrix6d>& scatter, bool of_keyframes) {
  Vector6d sum = Vector6d::Zero();
  int count = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    if (log[i].keyframe.valid() != of_keyframes) continue;
    sum += scatter[i].diagonal();
    ++count;
  }
  return {std::sqrt(sum.head<3>().mean() / count), std::sqrt(sum.tail<3>().mean() / count)};
}

TEST(OffConstantMotion, IsZeroOnATwist) {
  const Vector6d twist = (Vector6d() << 0.1, 0.2, -0.1, 0.3, -0.2, 0.5).finished();
  const auto pose = [&](int64_t ms) {
    return StampedPose{ms * 1'000'000, SE3::exp(1e-3 * double(ms) * twist)};
  };
  const auto off = off_constant_motion(pose(10), pose(43), pose(110));
  ASSERT_TRUE(off);
  EXPECT_LT(off->norm(), 1e-12);
}

TEST(OffConstantMotion, IsUnknownAcrossAGap) {
  EXPECT_FALSE(off_constant_motion({0, {}}, {33'000'000, {}}, {700'000'000, {}}));
  EXPECT_FALSE(off_constant_motion({0, {}}, {0, {}}, {33'000'000, {}}));
}

TEST(PoseScatter, IsThatOfIndependentErrors) {
  Map map;
  const FrameLog log = noisy_log(map);
  const auto scatter = pose_scatter(log, map);
  // One in ten neighbours is a keyframe, whose errors are larger.
  const double factor = std::sqrt((0.1 * (kKeyframeFactor * kKeyframeFactor) + 0.9));
  const Eigen::Vector2d frames = mean_sigma(log, scatter, false);
  EXPECT_NEAR(frames.x() / kNoise_m, factor, 0.15 * factor);
  EXPECT_NEAR(frames.y() / kNoise_rad, factor, 0.15 * factor);
}

TEST(PoseScatter, OfKeyframesIsTheirOwn) {
  Map map;
  const FrameLog log = noisy_log(map);
  const Eigen::Vector2d keyframes = mean_sigma(log, pose_scatter(log, map), true);
  // Their neighbours are frames: (9 + 2 / 4) / 1.5 of the variance of a frame.
  EXPECT_NEAR(keyframes.x() / kNoise_m, std::sqrt(9.5 / 1.5), 0.4);
  EXPECT_NEAR(keyframes.y() / kNoise_rad, std::sqrt(9.5 / 1.5), 0.4);
}

TEST(PoseScatter, LostAndRepeatedFramesHaveNoPartInIt) {
  Map map;
  FrameLog log = noisy_log(map);
  log.resize(3);
  log[0].outcome = TrackingOutcome::kLost;
  EXPECT_TRUE(pose_scatter(log, map)[1].isZero(0));
  log[0].outcome = TrackingOutcome::kTracked;
  log[2].method = TrackingMethod::kRepeat;
  EXPECT_TRUE(pose_scatter(log, map)[1].isZero(0));
  log[2].method = TrackingMethod::kPatches;
  EXPECT_FALSE(pose_scatter(log, map)[1].isZero(0));
}

}  // namespace
}  // namespace kinloop
