#include <gtest/gtest.h>

#include "apps/run/summary/run_summary.hpp"
#include "kinloop/sensor/camera/camera_presets.hpp"
#include "tests/optimize/bundle_world.hpp"

namespace kinloop {
namespace {

constexpr double kModel_per_m = 4e-3;

/// A solved problem whose depth is `scale` times as noisy as the model says.
struct Solved {
  explicit Solved(double scale, double outlier_fraction = 0) {
    test::BundleWorldSettings settings;
    settings.sigma_px = 1;
    settings.sigma_inverse_depth = scale * kModel_per_m;
    settings.outlier_fraction = outlier_fraction;
    problem = test::make_bundle_world(settings).problem;
    problem.sensor.noise.keypoint = {kModel_per_m};
    const BundleSolution solution = solve_bundle(problem, {});
    problem.T_world_camera = solution.T_world_camera;
    problem.p_world = solution.p_world;
  }
  [[nodiscard]] std::optional<double> noise_scale() const { return depth_noise_scale(problem); }

  BundleProblem problem;
};

/// Three standard errors of a median of differences of some 500 residuals.
constexpr double kTolerance = 0.1;

TEST(DepthNoiseScale, IsThatOfTheMeasurements) {
  for (const double scale : {0.5, 1.0, 2.0, 4.0}) {
    const auto found = Solved(scale).noise_scale();
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found / scale, 1, kTolerance) << scale;
  }
}

TEST(DepthNoiseScale, OutliersChangeItLittle) {
  for (const double scale : {1.0, 2.0}) {
    const auto found = Solved(scale, 0.1).noise_scale();
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found / scale, 1, kTolerance) << scale;
  }
}

TEST(DepthNoiseScale, IsRelativeToTheModel) {
  Solved solved(1);
  const auto before = solved.noise_scale();
  DepthNoise& model = solved.problem.sensor.noise.keypoint;
  model = model.times(4);
  ASSERT_TRUE(before);
  EXPECT_NEAR(solved.noise_scale().value(), *before / 4, 1e-9);
}

TEST(DepthNoiseScale, NeedsDepth) {
  Solved solved(1);
  for (BundleObservation& seen : solved.problem.observations) seen.depth_m = 0;
  EXPECT_FALSE(solved.noise_scale());
}

TEST(DepthNoiseScale, IsUnknownWithoutAMap) {
  const Slam slam(camera_preset("freiburg1").value());
  EXPECT_FALSE(depth_noise_scale(slam));
}

}  // namespace
}  // namespace kinloop
