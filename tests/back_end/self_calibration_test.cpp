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

TEST(SelfCalibration, DisabledMeansAllParametersAreFixed) {
  SelfCalibrationOptions options;
  options.enabled = false;
  EXPECT_TRUE(sensor_prior(nominal_estimate(some_camera()), options).free_parameters().empty());
}

TEST(SelfCalibration, ATypicalReadoutIsLeftOnlyWithinItsSpreadDuringTheRun) {
  RgbdCamera camera = some_camera();
  camera.rolling_shutter_s.reset();
  camera.sensor = depth_sensor(DepthSensorModel::kKinect1, SensorOrigin::kSource);
  const SensorEstimate nominal = nominal_estimate(camera);
  const SelfCalibrationOptions options;
  const SensorPrior during = time_prior(nominal, options), at_end = sensor_prior(nominal, options);
  for (const int k : {kRollingShutter, kDepthShutter}) {
    EXPECT_EQ(during.mean(k), camera.sensor.typical_readout_s);
    EXPECT_EQ(during.sigma(k), camera.sensor.typical_readout_sigma_s);
    EXPECT_EQ(at_end.sigma(k), options.time_sigma_s);
  }
  EXPECT_EQ(during.sigma(kDepthDelay), options.time_sigma_s) << "nothing is known of it";
}

TEST(SelfCalibration, ACalibratedReadoutIsProtectedAndATypicalOneIsNot) {
  RgbdCamera camera = some_camera();
  camera.sensor = depth_sensor(DepthSensorModel::kKinect1, SensorOrigin::kSource);
  const double near_s = 0.0215, sigma_s = 1e-3;
  const SensorPrior calibrated = time_prior(nominal_estimate(camera), {});
  EXPECT_FALSE(calibrated.accepts(kRollingShutter, near_s, sigma_s));
  camera.rolling_shutter_s.reset();
  const SensorPrior typical = time_prior(nominal_estimate(camera), {});
  EXPECT_TRUE(typical.accepts(kRollingShutter, near_s, sigma_s));
  EXPECT_FALSE(typical.accepts(kRollingShutter, near_s, 3 * sigma_s)) << "the data say too little";
}

/// Points in front of four cameras whose principal point is off by `off_px`.
BundleAdjustmentProblem decentred_problem(double off_px) {
  BundleAdjustmentProblem problem;
  BundleProblem& bundle = problem.bundle;
  bundle.sensor.camera = some_camera().color;
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
      bundle.observations.push_back({{bundle.sensor.camera.project(p) + error, p.z()}, pose, point});
    }
  }
  for (uint32_t i = 0; i < bundle.p_world.size(); ++i) problem.landmarks.push_back(LandmarkId{i});
  problem.observations.resize(bundle.observations.size());
  return problem;
}

SensorEstimate center_found(double off_px) {
  SelfCalibrationOptions nothing;
  nothing.enabled = false;
  BundleAdjustmentProblem problem = decentred_problem(off_px);
  problem.bundle.prior = sensor_prior(nominal_estimate(problem.bundle.sensor), nothing);
  problem.bundle.prior.sigma(kCenterX) = 3;
  return run_self_calibration(problem, {}).sensor;
}

TEST(SelfCalibration, EstimatesAnObservableError) {
  const SensorEstimate found = center_found(4);
  EXPECT_TRUE(found.used[kCenterX]);
  EXPECT_NEAR(found.sensor.corrections(kCenterX), 4, 3 * found.sigma(kCenterX));
}

TEST(SelfCalibration, IgnoresInsignificantDifferences) {
  const SensorEstimate found = center_found(0);
  EXPECT_GT(found.sigma(kCenterX), 0);
  EXPECT_FALSE(found.used[kCenterX]);
  EXPECT_EQ(found.sensor.corrections(kCenterX), 0);
}

}  // namespace
}  // namespace kinloop
