#include "kinloop/back_end/self_calibration.hpp"

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

RgbdCamera some_camera() {
  RgbdCamera camera;
  camera.color = {640, 480, 525, 524, 319.5, 239.5, {}};
  camera.rolling_shutter_s = 0.02;
  camera.depth_delay_s = 0.01;
  return camera;
}

TEST(SelfCalibration, StartsFromTheNominalCalibration) {
  const SensorVector known = nominal_sensor(some_camera());
  EXPECT_EQ(known(kRollingShutter), 0.02);
  EXPECT_EQ(known(kDepthShutter), 0.02);
  EXPECT_EQ(known(kDepthDelay), 0.01);
  EXPECT_EQ(known(kFocalX), 0);
}

TEST(SelfCalibration, WithoutEstimatesTheCameraIsUnchanged) {
  SensorEstimate nothing;
  nothing.value = nominal_sensor(some_camera());
  const RgbdCamera calibrated = calibrated_camera(some_camera(), nothing);
  EXPECT_EQ(calibrated.color.fx, 525);
  EXPECT_EQ(calibrated.color.lens.k1, 0);
  EXPECT_EQ(calibrated.rolling_shutter_s, 0.02);
  EXPECT_EQ(calibrated.depth_delay_s, 0.01);
}

TEST(SelfCalibration, EstimatesAreAppliedToTheCamera) {
  SensorEstimate found;
  found.value(kFocalX) = 3;
  found.value(kRadial1) = 0.02;
  found.value(kRollingShutter) = 0.03;
  found.used[kFocalX] = found.used[kRadial1] = found.used[kRollingShutter] = true;
  const RgbdCamera camera = some_camera();
  const RgbdCamera calibrated = calibrated_camera(camera, found);
  EXPECT_EQ(calibrated.rolling_shutter_s, 0.03);
  EXPECT_EQ(calibrated.color.fx, 528);
  // A ray must reach the same pixel whether the correction is kept separate or applied to the camera.
  const Eigen::Vector2d ray(0.4, -0.3);
  const Eigen::Vector2d apart = camera.color.distort(corrected_pixel(camera.color, found.value, ray));
  const Eigen::Vector2d worked_in = calibrated.color.distort(calibrated.color.project({ray.x(), ray.y(), 1}));
  EXPECT_LT((apart - worked_in).norm(), 0.1);
}

TEST(SelfCalibration, FixedParametersKeepTheirEstimates) {
  SensorEstimate before, times;
  before.used[kFocalX] = true;
  before.sigma(kFocalX) = 0.5;
  before.sigma(kRollingShutter) = 0.01;
  times.used[kRollingShutter] = true;
  times.sigma(kRollingShutter) = 0.001;
  const SensorEstimate both = with_fixed_from(times, before);
  EXPECT_TRUE(both.used[kFocalX]);
  EXPECT_EQ(both.sigma(kFocalX), 0.5);
  EXPECT_TRUE(both.used[kRollingShutter]);
  EXPECT_EQ(both.sigma(kRollingShutter), 0.001);
}

TEST(SelfCalibration, DisabledMeansAllParametersAreFixed) {
  SelfCalibrationOptions options;
  options.enabled = false;
  EXPECT_TRUE(prior_sigmas(some_camera().color, options).isZero(0));
}

/// Points in front of four cameras whose principal point is off by `off_px`.
BundleAdjustmentProblem decentred_problem(double off_px) {
  BundleAdjustmentProblem problem;
  BundleProblem& bundle = problem.bundle;
  bundle.camera = some_camera().color;
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    bundle.p_world.push_back(test::uniform_vector<3>(random, {-1, -0.7, 1.5}, {1, 0.7, 3}));
  }
  for (uint32_t pose = 0; pose < 4; ++pose) {
    bundle.T_world_camera.push_back(
        {exp_so3({0.05 * pose, 0.1 * pose, 0.3 * pose}), {0.1 * pose, -0.05 * pose, 0}});
    bundle.fixed.push_back(pose == 0 ? 1 : 0);
    problem.keyframes.push_back(KeyframeId{pose});
    for (uint32_t point = 0; point < bundle.p_world.size(); ++point) {
      const Eigen::Vector3d p = bundle.T_world_camera[pose].inverse() * bundle.p_world[point];
      const double error_y = random.uniform(-0.5, 0.5);
      const Eigen::Vector2d error(off_px + random.uniform(-0.5, 0.5), error_y);
      bundle.observations.push_back({{bundle.camera.project(p) + error, p.z()}, pose, point});
    }
  }
  for (uint32_t i = 0; i < bundle.p_world.size(); ++i) problem.landmarks.push_back(LandmarkId{i});
  problem.observations.resize(bundle.observations.size());
  return problem;
}

SensorEstimate center_found(double off_px) {
  SensorVector expected = SensorVector::Zero();
  expected(kCenterX) = 3;
  return run_self_calibration(decentred_problem(off_px), expected, {}, {}).sensor;
}

TEST(SelfCalibration, EstimatesAnObservableError) {
  const SensorEstimate found = center_found(4);
  EXPECT_TRUE(found.used[kCenterX]);
  EXPECT_NEAR(found.value(kCenterX), 4, 3 * found.sigma(kCenterX));
}

TEST(SelfCalibration, IgnoresInsignificantDifferences) {
  const SensorEstimate found = center_found(0);
  EXPECT_GT(found.sigma(kCenterX), 0);
  EXPECT_FALSE(found.used[kCenterX]);
  EXPECT_EQ(found.value(kCenterX), 0);
}

}  // namespace
}  // namespace kinloop
