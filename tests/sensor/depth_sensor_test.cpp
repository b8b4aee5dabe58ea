#include "kinloop/sensor/depth_sensor.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace kinloop {
namespace {

class EveryDepthSensor : public testing::TestWithParam<EnumName<DepthSensorModel>> {
 protected:
  DepthSensor sensor_ = depth_sensor(GetParam().value, SensorOrigin::kSource);
};

TEST_P(EveryDepthSensor, ConfirmsItsPreset) {
  EXPECT_EQ(sensor_.model, GetParam().value);
  EXPECT_EQ(sensor_.origin, SensorOrigin::kSource);
  EXPECT_GT(sensor_.min_depth_m, 0);
  EXPECT_LT(sensor_.min_depth_m, sensor_.max_depth_m);
}

TEST_P(EveryDepthSensor, NoiseIsPositiveContinuousAndGrowsWithDistance) {
  constexpr double kStep_m = 1e-3;
  ASSERT_GT(sensor_.max_depth_m, sensor_.min_depth_m + 1);
  for (double z = sensor_.min_depth_m; z < sensor_.max_depth_m; z += kStep_m) {
    const double here_m = sensor_.noise.sigma_m(z), farther_m = sensor_.noise.sigma_m(z + kStep_m);
    ASSERT_GT(here_m, 0) << z;
    ASSERT_GT(farther_m, here_m) << z;
    ASSERT_LT(farther_m, 1.02 * here_m) << z;
  }
}

TEST_P(EveryDepthSensor, NoiseOfInverseDepthIsThatOfDepth) {
  for (const double z : {0.5, 1.0, 2.0, 4.0}) {
    EXPECT_NEAR(sensor_.noise.inverse_sigma_per_m(1 / z) * z * z, sensor_.noise.sigma_m(z), 1e-15);
    EXPECT_NEAR(sensor_.noise.difference_sigma_m(z, z), std::sqrt(2.0) * sensor_.noise.sigma_m(z), 1e-15);
    EXPECT_NEAR(sensor_.noise.times(3).sigma_m(z), 3 * sensor_.noise.sigma_m(z), 1e-15);
  }
}

TEST_P(EveryDepthSensor, OnlyTriangulationHasConstantNoiseInInverseDepth) {
  const bool constant =
      sensor_.noise.inverse_sigma_per_m(1 / 0.5) == sensor_.noise.inverse_sigma_per_m(1 / 4.0);
  EXPECT_EQ(constant, sensor_.kind != DepthSensorKind::kTimeOfFlight);
}

INSTANTIATE_TEST_SUITE_P(DepthSensor, EveryDepthSensor, testing::ValuesIn(option_names(DepthSensorModel{})),
                         [](const auto& model) { return std::string(model.param.name); });

double sigma_mm(DepthSensorModel model, double depth_m) {
  return 1e3 * depth_sensor(model, SensorOrigin::kSource).noise.sigma_m(depth_m);
}

TEST(DepthSensor, AKinect1IsTheDefaultToTheLastBit) {
  const DepthSensor preset = depth_sensor(DepthSensorModel::kKinect1, SensorOrigin::kSource);
  EXPECT_EQ(preset.kind, DepthSensor{}.kind);
  EXPECT_EQ(preset.min_depth_m, DepthSensor{}.min_depth_m);
  EXPECT_EQ(preset.max_depth_m, DepthSensor{}.max_depth_m);
  for (const double z : {0.4, 1.1, 3.7, 9.9}) {
    EXPECT_EQ(preset.noise.sigma_m(z), DepthNoise{}.sigma_m(z));
    EXPECT_EQ(preset.noise.inverse_sigma_per_m(1 / z), kSensorInverseDepthSigmaPerM);
  }
}

TEST(DepthSensor, PresetsAreInTheOrderOfTheirSources) {
  using enum DepthSensorModel;
  EXPECT_LT(sigma_mm(kAzureKinect, 3), sigma_mm(kKinect2, 3));
  EXPECT_LT(sigma_mm(kKinect2, 3), sigma_mm(kKinect1, 3));
  EXPECT_LT(sigma_mm(kKinect1, 3), sigma_mm(kRealsenseD4xx, 3));
  EXPECT_LT(sigma_mm(kKinect2, 3), sigma_mm(kHololens, 3));
  EXPECT_LT(sigma_mm(kHololens, 3), sigma_mm(kIphone, 3));
  EXPECT_LT(sigma_mm(kRealsenseL515, 9), sigma_mm(kRealsenseD4xx, 9));
  EXPECT_NEAR(sigma_mm(kRealsenseL515, 1), 2.5, 0.01);
  EXPECT_NEAR(sigma_mm(kRealsenseL515, 9), 15.5, 0.01);
}

TEST(DepthSensor, ACameraFileIsRightAndASourceKnowsBetterThanTheDefault) {
  DepthSensor sensor;
  EXPECT_EQ(sensor.origin, SensorOrigin::kAssumed);
  sensor.set_by_source(DepthSensorModel::kKinect2);
  EXPECT_EQ(sensor.model, DepthSensorModel::kKinect2);
  EXPECT_EQ(sensor.origin, SensorOrigin::kSource);
  sensor = depth_sensor(DepthSensorModel::kStereo, SensorOrigin::kCameraFile);
  sensor.set_by_source(DepthSensorModel::kKinect2);
  EXPECT_EQ(sensor.model, DepthSensorModel::kStereo);
}

}  // namespace
}  // namespace kinloop
