#include "kinloop/slam/self_calibration.hpp"

#include <gtest/gtest.h>

namespace kinloop {
namespace {

RgbdCamera some_camera() {
  RgbdCamera camera;
  camera.color = {640, 480, 525, 524, 319.5, 239.5};
  camera.rolling_shutter_s = 0.02;
  camera.depth_offset_s = 0.01;
  return camera;
}

TEST(SelfCalibration, StartsFromWhatTheCameraFileSays) {
  const SensorVector known = known_sensor(some_camera());
  EXPECT_EQ(known(kRollingShutter), 0.02);
  EXPECT_EQ(known(kDepthShutter), 0.02);
  EXPECT_EQ(known(kDepthTime), 0.01);
  EXPECT_EQ(known(kFocalX), 0);
}

TEST(SelfCalibration, WhereNothingWasFoundTheCameraStaysAsItWas) {
  SensorEstimate nothing;
  nothing.value = known_sensor(some_camera());
  const RgbdCamera calibrated = calibrated_camera(some_camera(), nothing);
  EXPECT_EQ(calibrated.color.fx, 525);
  EXPECT_EQ(calibrated.color.k1, 0);
  EXPECT_EQ(calibrated.rolling_shutter_s, 0.02);
  EXPECT_EQ(calibrated.depth_offset_s, 0.01);
}

TEST(SelfCalibration, WhatWasFoundIsWorkedIntoTheCamera) {
  SensorEstimate found;
  found.value(kFocalX) = 3;
  found.value(kRadial1) = 0.02;
  found.value(kRollingShutter) = 0.03;
  found.used[kFocalX] = found.used[kRadial1] = found.used[kRollingShutter] = true;
  const RgbdCamera camera = some_camera();
  const RgbdCamera calibrated = calibrated_camera(camera, found);
  EXPECT_EQ(calibrated.rolling_shutter_s, 0.03);
  EXPECT_EQ(calibrated.color.fx, 528);
  // A ray falls on the same pixel whether the correction is kept apart or worked in.
  const Eigen::Vector2d ray(0.4, -0.3);
  const Eigen::Vector2d apart = camera.color.distort(corrected_pixel(camera.color, found.value, ray));
  const Eigen::Vector2d worked_in = calibrated.color.distort(calibrated.color.project({ray.x(), ray.y(), 1}));
  EXPECT_LT((apart - worked_in).norm(), 0.1);
}

TEST(SelfCalibration, OffMeansThatNothingMayMove) {
  SelfCalibrationOptions options;
  options.enabled = false;
  EXPECT_TRUE(expected_sigmas(some_camera().color, options).isZero(0));
}

}  // namespace
}  // namespace kinloop
