#include "kinloop/sensor/sensor.hpp"

#include <algorithm>
#include <string>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "kinloop/sensor/sensor_estimate.hpp"

namespace kinloop {
namespace {

RgbdCamera some_camera() {
  RgbdCamera camera;
  camera.color = {640, 480, 525, 524, 319.5, 239.5, {}};
  camera.rolling_shutter_s = 0.02;
  camera.depth_delay_s = 0.01;
  return camera;
}

TEST(NoiseModel, DefaultsAreThoseOfTheOptionsAndAKinect) {
  const NoiseModel made = make_noise_model({}, {}), byself;
  EXPECT_EQ(made.plane.coefficient_per_m, byself.plane.coefficient_per_m);
  EXPECT_EQ(made.keypoint.coefficient_per_m, byself.keypoint.coefficient_per_m);
  EXPECT_EQ(made.point_pair.coefficient_per_m, byself.point_pair.coefficient_per_m);
  EXPECT_EQ(made.surface.coefficient_per_m, byself.surface.coefficient_per_m);
  EXPECT_EQ(made.robust_width, byself.robust_width);
  EXPECT_EQ(made.inlier_chi2_pixel, byself.inlier_chi2_pixel);
  EXPECT_EQ(made.inlier_chi2_depth, byself.inlier_chi2_depth);
}

TEST(NoiseModel, OptionsScaleAllButThePlane) {
  const NoiseOptions options{
      .inverse_depth_sigma_per_m = 0.012, .robust_width = 2, .inlier_chi2_pixel = 9, .inlier_chi2_depth = 6};
  const NoiseModel noise = make_noise_model(options, {});
  EXPECT_EQ(noise.plane.coefficient_per_m, kSensorInverseDepthSigmaPerM);
  EXPECT_EQ(noise.keypoint.coefficient_per_m, 0.012);
  EXPECT_DOUBLE_EQ(noise.point_pair.coefficient_per_m, 2 * kPointPairInverseDepthSigmaPerM);
  EXPECT_DOUBLE_EQ(noise.surface.coefficient_per_m, 2 * kSensorInverseDepthSigmaPerM);
  EXPECT_EQ(noise.robust_width, 2);
  EXPECT_EQ(noise.inlier_chi2_pixel, 9);
  EXPECT_EQ(noise.inlier_chi2_depth, 6);
}

TEST(NoiseModel, TheNoiseOfTheSensorScalesAll) {
  RgbdCamera camera = some_camera();
  camera.sensor.noise = {3 * kSensorInverseDepthSigmaPerM, 1.5};
  const NoiseModel noise = make_sensor(camera).noise;
  EXPECT_DOUBLE_EQ(noise.keypoint.coefficient_per_m, 3 * kKeypointInverseDepthSigmaPerM);
  EXPECT_DOUBLE_EQ(noise.point_pair.coefficient_per_m, 3 * kPointPairInverseDepthSigmaPerM);
  for (const DepthNoise& any : {noise.plane, noise.surface}) {
    EXPECT_DOUBLE_EQ(any.sigma_m(2), camera.sensor.noise.sigma_m(2));
  }
  for (const DepthNoise& any : {noise.plane, noise.surface, noise.keypoint, noise.point_pair}) {
    EXPECT_EQ(any.crossover_m, 1.5);
  }
}

TEST(Sensor, StartsFromTheNominalCalibration) {
  const SensorVector nominal = make_sensor(some_camera()).corrections;
  EXPECT_EQ(nominal(kRollingShutter), 0.02);
  EXPECT_EQ(nominal(kDepthShutter), 0.02);
  EXPECT_EQ(nominal(kDepthDelay), 0.01);
  EXPECT_EQ(nominal(kFocalX), 0);
}

TEST(Sensor, AReadoutThatIsNotKnownIsThatTypicalOfTheSensor) {
  RgbdCamera camera = some_camera();
  camera.rolling_shutter_s.reset();
  EXPECT_EQ(make_sensor(camera).corrections(kRollingShutter), 0) << "the sensor is only assumed";
  camera.sensor = depth_sensor(DepthSensorModel::kKinect1, SensorOrigin::kCameraFile);
  EXPECT_EQ(make_sensor(camera).corrections(kRollingShutter), 0.03);
  EXPECT_EQ(make_sensor(camera).corrections(kDepthShutter), 0.03);
  camera.sensor = depth_sensor(DepthSensorModel::kHololens, SensorOrigin::kCameraFile);
  EXPECT_EQ(make_sensor(camera).corrections(kRollingShutter), 0);
}

TEST(Sensor, OnlyStructuredLightReadsDepthRowByRow) {
  RgbdCamera camera = some_camera();
  for (const auto model : {DepthSensorModel::kKinect2, DepthSensorModel::kRealsenseD4xx}) {
    camera.sensor = depth_sensor(model, SensorOrigin::kSource);
    EXPECT_EQ(make_sensor(camera).corrections(kRollingShutter), 0.02);
    EXPECT_EQ(make_sensor(camera).corrections(kDepthShutter), 0);
  }
}

TEST(SensorEstimate, ATypicalReadoutThatWasNotEstimatedStaysUnknown) {
  RgbdCamera camera = some_camera();
  camera.rolling_shutter_s.reset();
  camera.sensor = depth_sensor(DepthSensorModel::kKinect1, SensorOrigin::kSource);
  SensorEstimate estimate = nominal_estimate(make_sensor(camera));
  EXPECT_FALSE(calibrated_camera(camera, estimate).rolling_shutter_s);
  estimate.sensor.corrections(kRollingShutter) = 0;
  EXPECT_EQ(calibrated_camera(camera, estimate).rolling_shutter_s, 0);
}

TEST(SensorEstimate, WithoutEstimatesTheCameraIsUnchanged) {
  const SensorEstimate nothing = nominal_estimate(make_sensor(some_camera()));
  const RgbdCamera calibrated = calibrated_camera(some_camera(), nothing);
  EXPECT_EQ(calibrated.color.fx, 525);
  EXPECT_EQ(calibrated.color.lens.k1, 0);
  EXPECT_EQ(calibrated.rolling_shutter_s, 0.02);
  EXPECT_EQ(calibrated.depth_delay_s, 0.01);
}

TEST(SensorEstimate, EstimatesAreAppliedToTheCamera) {
  const RgbdCamera camera = some_camera();
  SensorEstimate found{Sensor{camera.color}};
  found.sensor.corrections(kFocalX) = 3;
  found.sensor.corrections(kRadial1) = 0.02;
  found.sensor.corrections(kRollingShutter) = 0.03;
  found.used[kFocalX] = found.used[kRadial1] = found.used[kRollingShutter] = true;
  const RgbdCamera calibrated = calibrated_camera(camera, found);
  EXPECT_EQ(calibrated.rolling_shutter_s, 0.03);
  EXPECT_EQ(calibrated.color.fx, 528);
  // A ray must reach the same pixel whether the correction is kept separate or applied to the camera.
  const Eigen::Vector2d ray(0.4, -0.3);
  const Eigen::Vector2d apart = camera.color.distort(corrected_pixel(found.sensor, ray));
  const Eigen::Vector2d worked_in = calibrated.color.distort(calibrated.color.project({ray.x(), ray.y(), 1}));
  EXPECT_LT((apart - worked_in).norm(), 0.1);
}

TEST(SensorEstimate, FixedParametersKeepTheirEstimates) {
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

TEST(Sensor, CorrectedCameraMatchesTheCorrections) {
  PinholeCamera camera = some_camera().color;
  camera.lens.k1 = 0.26;
  camera.lens.k2 = -0.95;
  camera.lens.k3 = 1.16;
  camera.lens.p1 = -0.005;
  EXPECT_NEAR(corrected_camera(Sensor{camera}).lens.k3, camera.lens.k3, 1e-9);
  SensorVector correction = SensorVector::Zero();
  correction(kFocalX) = 4;
  correction(kFocalY) = 3;
  correction(kCenterX) = -1.5;
  correction(kRadial1) = 0.01;
  const PinholeCamera corrected = corrected_camera({camera, {}, correction});
  // A ray must reach the same raw pixel both ways: corrected pinhole and nominal lens, or the corrected lens.
  for (double x = -0.5; x <= 0.5; x += 0.1) {
    for (double y = -0.4; y <= 0.4; y += 0.1) {
      const double distortion = 1 + correction(kRadial1) * (x * x + y * y);
      const Eigen::Vector2d undistorted((camera.fx + 4) * x * distortion + camera.cx - 1.5,
                                        (camera.fy + 3) * y * distortion + camera.cy);
      const Eigen::Vector2d raw = corrected.distort(corrected.project({x, y, 1}));
      EXPECT_LT((camera.distort(undistorted) - raw).norm(), 0.1) << x << " " << y;
    }
  }
}

TEST(Sensor, TheCorrectedCameraKeepsTheModelOfItsLens) {
  for (const LensDistortion& lens :
       {LensDistortion{LensModel::kRational, 0.58, -2.49, 6.5e-4, -1.8e-4, 1.36, 0.46, -2.34, 1.3},
        LensDistortion{LensModel::kKannalaBrandt, -0.0065, 0.0421, 0, 0, -0.0396, 0.0069}}) {
    PinholeCamera camera = some_camera().color;
    camera.lens = lens;
    const PinholeCamera same = corrected_camera(Sensor{camera});
    SensorVector correction = SensorVector::Zero();
    correction(kFocalX) = correction(kFocalY) = 3;
    correction(kRadial1) = 0.01;
    const PinholeCamera corrected = corrected_camera({camera, {}, correction});
    EXPECT_EQ(corrected.lens.model, lens.model);
    for (double x = -0.5; x <= 0.5; x += 0.1) {
      for (double y = -0.4; y <= 0.4; y += 0.1) {
        const Eigen::Vector2d ideal = camera.project({x, y, 1});
        EXPECT_LT((same.distort(ideal) - camera.distort(ideal)).norm(), 1e-6);
        const Eigen::Vector2d raw = corrected.distort(corrected.project({x, y, 1}));
        const Eigen::Vector2d expected = camera.distort(corrected_pixel({camera, {}, correction}, {x, y}));
        EXPECT_LT((raw - expected).norm(), 0.1) << x << " " << y;
      }
    }
  }
}

TEST(Sensor, EveryParameterHasAName) {
  std::vector<std::string> names;
  for (int i = 0; i < kSensorParameterCount; ++i) {
    names.emplace_back(sensor_parameter_name(static_cast<SensorParameter>(i)));
  }
  EXPECT_THAT(names, testing::Each(testing::Ne("")));
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::unique(names.begin(), names.end()), names.end());
}

TEST(RawPixelOf, IsThePixelOfThePointWhenItsRowIsRead) {
  PinholeCamera camera = some_camera().color;
  camera.lens.k1 = 0.1;
  Sensor sensor{camera};
  sensor.corrections(kRollingShutter) = 0.03;
  const Velocity velocity{{0.3, -0.1, 0.2}, {0.4, 0.8, -0.3}};
  const Eigen::Vector3d p_camera(0.4, 0.5, 2);
  const auto raw = raw_pixel_of(sensor, p_camera, velocity);
  ASSERT_TRUE(raw);
  const double row = raw->y() / camera.height - 0.5;
  const Eigen::Vector3d p_row = point_in_later_camera(p_camera, velocity, color_time_s(sensor, row));
  EXPECT_LT((camera.distort(camera.project(p_row)) - *raw).norm(), 0.01);
  EXPECT_FALSE(raw_pixel_of(sensor, {0, 0, -1}, velocity));
}

}  // namespace
}  // namespace kinloop
