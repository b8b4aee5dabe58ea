#include "kinloop/slam/options.hpp"

#include <limits>
#include <set>

#include <gmock/gmock.h>

#include "kinloop/slam/slam.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::usage_error;
using testing::AllOf;
using testing::HasSubstr;

RgbdCamera any_camera() {
  RgbdCamera camera;
  camera.color = {64, 48, 50, 50, 31.5, 23.5, {}};
  return camera;
}

std::string error_of(const SlamOptions& options) {
  return usage_error([&] { const Slam slam(any_camera(), options); });
}

TEST(SlamOptions, SlamRejectsValuesOutOfRange) {
  SlamOptions options;
  options.features.count = 1;
  EXPECT_THAT(error_of(options),
              AllOf(HasSubstr("features.count"), HasSubstr("'1'"), HasSubstr("from 50 to 20000")));
}

TEST(SlamOptions, SlamRejectsNonFiniteNumbers) {
  SlamOptions options;
  options.noise.inverse_depth_sigma_per_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("noise.inverse_depth_sigma_per_m"), HasSubstr("'nan'")));
}

TEST(SlamOptions, SlamRejectsInvalidEnumValues) {
  SlamOptions options;
  options.executor.mode = static_cast<ExecutorMode>(9);
  EXPECT_THAT(error_of(options), AllOf(HasSubstr("executor.mode"), HasSubstr("one of inline, lagged, live")));
}

TEST(SlamOptions, MaximumThreadCountIsAllowed) {
  SlamOptions options;
  options.global_ba.threads = 1024;  // maximum of --threads
  EXPECT_NO_THROW(validate(options));
}

TEST(SlamOptions, NoiseReachesEverySolver) {
  SlamOptions given;
  given.noise = {
      .inverse_depth_sigma_per_m = 0.012, .robust_width = 2, .inlier_chi2_pixel = 9, .inlier_chi2_depth = 6};
  const SlamOptions options = resolve_options(given);
  const auto expect_noise = [](const auto& solver) {
    EXPECT_EQ(solver.depth_noise.coefficient_per_m, 0.012);
    EXPECT_EQ(solver.robust_width, 2);
    EXPECT_EQ(solver.inlier_chi2_pixel, 9);
    EXPECT_EQ(solver.inlier_chi2_depth, 6);
  };
  expect_noise(options.tracking.pose);
  expect_noise(options.tracking.pnp.pose);
  expect_noise(options.mapping.local_ba);
  expect_noise(options.global_ba);
  EXPECT_DOUBLE_EQ(options.tracking.rigid.depth_noise.coefficient_per_m, 2 * kPointPairInverseDepthSigmaPerM);
  EXPECT_DOUBLE_EQ(options.tracking.icp.depth_noise.coefficient_per_m, 2 * kSensorInverseDepthSigmaPerM);
}

TEST(SlamOptions, TheNoiseOfTheSensorReachesEveryModule) {
  const DepthNoise sensor = {3 * kSensorInverseDepthSigmaPerM, 1.5};
  const SlamOptions options = resolve_options({}, sensor);
  for (const DepthNoise& noise : {options.tracking.pose.depth_noise, options.tracking.pnp.pose.depth_noise,
                                  options.mapping.local_ba.depth_noise, options.global_ba.depth_noise}) {
    EXPECT_DOUBLE_EQ(noise.coefficient_per_m, 3 * kKeypointInverseDepthSigmaPerM);
    EXPECT_EQ(noise.crossover_m, 1.5);
  }
  EXPECT_DOUBLE_EQ(options.tracking.rigid.depth_noise.coefficient_per_m, 3 * kPointPairInverseDepthSigmaPerM);
  EXPECT_EQ(options.tracking.rigid.depth_noise.crossover_m, 1.5);
  for (const DepthNoise& noise :
       {options.tracking.icp.depth_noise, options.loop.depth_noise, options.features.depth_noise}) {
    EXPECT_DOUBLE_EQ(noise.sigma_m(2), sensor.sigma_m(2));
  }
}

TEST(SlamOptions, DefaultNoiseMatchesTheSolverDefaults) {
  const SlamOptions options = resolve_options({});
  EXPECT_EQ(options.tracking.rigid.depth_noise.coefficient_per_m, kPointPairInverseDepthSigmaPerM);
  EXPECT_EQ(options.tracking.icp.depth_noise.coefficient_per_m, kSensorInverseDepthSigmaPerM);
  EXPECT_EQ(options.global_ba.depth_noise.coefficient_per_m, BundleOptions().depth_noise.coefficient_per_m);
}

}  // namespace
}  // namespace kinloop
