#include "kinloop/tracking/motion/motion_compensation.hpp"

#include <gtest/gtest.h>

#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

/// Simulates `still` measured by the same camera in motion. The scene around each keypoint is a plane facing
/// the camera, so its depth gradient is zero.
Features in_motion(const Features& still, const Sensor& sensor, const Velocity& velocity) {
  const PinholeCamera& camera = sensor.camera;
  Features moving = still;
  for (size_t i = 0; i < still.size(); ++i) {
    const Eigen::Vector3d p =
        camera.unproject(still.pixels[i].cast<double>(), static_cast<double>(still.depths_m[i]));
    // The row depends on the exposure time, and the time on the row.
    Eigen::Vector2d pixel = still.pixels[i].cast<double>();
    double row = 0;
    for (int round = 0; round < 20; ++round) {
      row = pixel.y() / camera.height - 0.5;
      pixel = corrected_pixel(
          sensor,
          point_in_later_camera(p, velocity, sensor.corrections(kRollingShutter) * row).hnormalized());
    }
    const Eigen::Vector3d p_at_depth =
        point_in_later_camera(p, velocity,
                              static_cast<double>(still.depth_stamp_difference_s) +
                                  sensor.corrections(kDepthDelay) + sensor.corrections(kDepthShutter) * row);
    moving.measured_pixels[i] = moving.raw_pixels[i] = pixel.cast<float>();
    moving.measured_depths_m[i] = static_cast<float>(p_at_depth.z());
  }
  moving.pixels = moving.measured_pixels;
  moving.depths_m = moving.measured_depths_m;
  return moving;
}

class MotionCompensation : public testing::Test {
 protected:
  MotionCompensation() {
    sensor_.corrections(kRollingShutter) = 0.03;
    sensor_.corrections(kDepthDelay) = 0.015;
    sensor_.corrections(kDepthShutter) = 0.03;
    velocity_ = {{0.3, -0.2, 0.4}, {0.8, -0.6, 0.5}};
  }

  test::SyntheticWorld world_ = test::make_world(2000, 1);
  Features ideal_ = *test::observe(world_, SE3{}, {0, 0, 0, 0}, 2).features;
  Sensor sensor_{world_.camera};
  Velocity velocity_;
};

TEST_F(MotionCompensation, MotionIsCompensated) {
  ideal_.depth_stamp_difference_s = 0.012F;
  const Features moving = in_motion(ideal_, sensor_, velocity_);
  const Features undone = deskew_features(moving, sensor_, velocity_);
  ASSERT_EQ(undone.size(), ideal_.size());
  double largest_shift_px = 0;
  for (size_t i = 0; i < ideal_.size(); ++i) {
    EXPECT_LT((undone.pixels[i] - ideal_.pixels[i]).norm(), 1e-4F);
    EXPECT_NEAR(undone.depths_m[i], ideal_.depths_m[i], 1e-6F);
    EXPECT_EQ(undone.measured_pixels[i], moving.measured_pixels[i]);
    largest_shift_px = std::max<double>(largest_shift_px, (moving.pixels[i] - ideal_.pixels[i]).norm());
  }
  EXPECT_GT(largest_shift_px, 5);  // the motion is significant
}

TEST_F(MotionCompensation, DepthOfAnotherTimeIsMovedToTheStamp) {
  ideal_.depth_stamp_difference_s = -0.02F;
  sensor_.corrections.setZero();
  EXPECT_TRUE(needs_deskewing(ideal_, sensor_));
  const Features moving = in_motion(ideal_, sensor_, velocity_);
  const Features undone = deskew_features(moving, sensor_, velocity_);
  double largest_shift_m = 0;
  for (size_t i = 0; i < ideal_.size(); ++i) {
    EXPECT_NEAR(undone.depths_m[i], ideal_.depths_m[i], 1e-6F);
    largest_shift_m = std::max<double>(largest_shift_m, std::abs(moving.depths_m[i] - ideal_.depths_m[i]));
  }
  EXPECT_GT(largest_shift_m, 0.01);
  ideal_.depth_stamp_difference_s = 0;
  EXPECT_FALSE(needs_deskewing(ideal_, sensor_));
}

TEST_F(MotionCompensation, LensAndDepthErrorsAreCorrected) {
  sensor_.corrections(kFocalX) = 3;
  sensor_.corrections(kCenterY) = -2;
  sensor_.corrections(kRadial1) = 0.01;
  Features moving = in_motion(ideal_, sensor_, velocity_);
  sensor_.corrections(kInverseDepthBias) = 0.01;  // the measured inverse depth is too small by this
  for (float& depth_m : moving.measured_depths_m) depth_m = 1 / (1 / depth_m - 0.01F);
  const Features undone = deskew_features(moving, sensor_, velocity_);
  for (size_t i = 0; i < ideal_.size(); ++i) {
    EXPECT_LT((undone.pixels[i] - ideal_.pixels[i]).norm(), 1e-4F);
    EXPECT_NEAR(undone.depths_m[i], ideal_.depths_m[i], 1e-6F);
  }
}

TEST_F(MotionCompensation, KeypointsWithoutDepthAreRotated) {
  velocity_.linear_m_s.setZero();
  Features moving = in_motion(ideal_, sensor_, velocity_);
  std::fill(moving.measured_depths_m.begin(), moving.measured_depths_m.end(), 0.0F);
  const Features undone = deskew_features(moving, sensor_, velocity_);
  for (size_t i = 0; i < ideal_.size(); ++i) {
    EXPECT_LT((undone.pixels[i] - ideal_.pixels[i]).norm(), 1e-4F);
    EXPECT_EQ(undone.depths_m[i], 0.0F);
  }
}

TEST_F(MotionCompensation, DepthGradientIsTakenIntoAccount) {
  // A wall at 45 degrees: z = 2 + x, so inverse depth is (1 - x / z) / 2, linear in the pixel.
  const PinholeCamera& camera = world_.camera;
  Features wall = ideal_;
  wall.inverse_depth_gradients.assign(wall.size(), Eigen::Vector2f(static_cast<float>(-0.5 / camera.fx), 0));
  const auto depth_at = [&](const Eigen::Vector2d& pixel) {
    return 2 / (1 - (pixel.x() - camera.cx) / camera.fx);
  };
  sensor_.corrections.setZero();
  sensor_.corrections(kDepthDelay) = 0.02;
  velocity_ = {{0.5, 0, 0}, {0, 0, 0}};
  std::vector<double> truth_m;
  for (size_t i = 0; i < wall.size(); ++i) {
    const Eigen::Vector2d pixel = wall.pixels[i].cast<double>();
    truth_m.push_back(depth_at(pixel));
    // The camera has moved along x when depth is measured: the point at the pixel then has z = 2 + x + v t.
    const double ray_x = (pixel.x() - camera.cx) / camera.fx;
    wall.measured_depths_m[i] = static_cast<float>((2 + 0.5 * 0.02) / (1 - ray_x));
  }
  const Features undone = deskew_features(wall, sensor_, velocity_);
  for (size_t i = 0; i < wall.size(); ++i) {
    if (truth_m[i] > 6) continue;  // beyond 6 m the inverse depth is too small to compare
    EXPECT_NEAR(undone.depths_m[i], truth_m[i], 4e-5 * truth_m[i] * truth_m[i]);
  }
}

TEST_F(MotionCompensation, AnIdealSensorChangesNothing) {
  const Features same = deskew_features(ideal_, Sensor{world_.camera}, velocity_);
  for (size_t i = 0; i < ideal_.size(); ++i) {
    EXPECT_LT((same.pixels[i] - ideal_.pixels[i]).norm(), 1e-6F);
    EXPECT_NEAR(same.depths_m[i], ideal_.depths_m[i], 1e-6F);
  }
}

}  // namespace
}  // namespace kinloop
