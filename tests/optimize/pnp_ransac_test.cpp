#include "kinloop/optimize/pose/ransac/pnp_ransac.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/optimize/synthetic_view.hpp"

namespace kinloop {
namespace {

using test::error_of;
using test::kinect;
using test::kinect_sensor;
using test::kNan;
using test::make_view;
using test::random_motion;

TEST(PnpRansac, RecoversTheTruthWithoutNoise) {
  Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const SE3 truth = random_motion(random, 3.0, 3.0);
    const auto view = make_view(truth, 60, {}, random);
    const auto solution = solve_pnp_ransac(kinect_sensor(), view, {}, {}, 17);
    ASSERT_TRUE(solution.has_value());
    EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 1e-6);
    EXPECT_EQ(solution->inlier_count, 60);
  }
}

TEST(PnpRansac, SurvivesSixtyPercentOutliers) {
  Random random(2);
  for (int trial = 0; trial < 10; ++trial) {
    const SE3 truth = random_motion(random, 2.0, 2.0);
    const test::ViewNoise noise{.sigma_px = 0.8, .sigma_inverse_depth = 2e-3, .outlier_fraction = 0.6};
    const auto view = make_view(truth, 200, noise, random);
    const auto solution = solve_pnp_ransac(kinect_sensor(), view, {}, {}, 5);
    ASSERT_TRUE(solution.has_value());
    EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 0.01);
    EXPECT_GT(solution->inlier_count, 55);
    EXPECT_LT(solution->inlier_count, 110);
  }
}

TEST(PnpRansac, DepthHelpsWithFewInliers) {
  Random random(7);
  for (int trial = 0; trial < 5; ++trial) {
    const SE3 truth = random_motion(random, 2.0, 2.0);
    const test::ViewNoise noise{
        .sigma_px = 0.8, .sigma_inverse_depth = 2e-3, .depth_fraction = 1, .outlier_fraction = 0.8};
    const auto view = make_view(truth, 300, noise, random);
    const auto solution = solve_pnp_ransac(kinect_sensor(), view, {}, {}, 11);
    ASSERT_TRUE(solution.has_value());
    EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 0.02);
  }
}

TEST(PnpRansac, NeedsNoDepth) {
  Random random(8);
  const SE3 truth = random_motion(random, 2.0, 2.0);
  const auto view =
      make_view(truth, 200, {.sigma_px = 0.8, .depth_fraction = 0, .outlier_fraction = 0.5}, random);
  const auto solution = solve_pnp_ransac(kinect_sensor(), view, {}, {}, 12);
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 0.02);
}

TEST(PnpRansac, SameSeedSameResult) {
  Random random(3);
  const SE3 truth = random_motion(random, 2.0, 2.0);
  const auto view = make_view(truth, 100, {.sigma_px = 1, .outlier_fraction = 0.4}, random);
  const auto first = solve_pnp_ransac(kinect_sensor(), view, {}, {}, 9);
  const auto second = solve_pnp_ransac(kinect_sensor(), view, {}, {}, 9);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->T_reference_camera.translation, second->T_reference_camera.translation);
  EXPECT_EQ(first->T_reference_camera.rotation.coeffs(), second->T_reference_camera.rotation.coeffs());
  EXPECT_EQ(first->inliers, second->inliers);
}

TEST(PnpRansac, RandomMatchesGiveNoSolution) {
  Random random(4);
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const auto view = make_view({}, 100, {.sigma_px = 1, .outlier_fraction = 1.0}, random);
    EXPECT_FALSE(solve_pnp_ransac(kinect_sensor(), view, {}, {}, seed).has_value());
  }
}

TEST(PnpRansac, DegenerateAndInvalidInputs) {
  Random random(5);
  const SE3 truth = random_motion(random, 2.0, 2.0);
  EXPECT_FALSE(solve_pnp_ransac(kinect_sensor(), {}, {}, {}, 1).has_value());
  EXPECT_FALSE(solve_pnp_ransac(kinect_sensor(), make_view(truth, 5, {}, random), {}, {}, 1).has_value());
  auto same = make_view(truth, 30, {}, random);
  for (auto& o : same) o = same.front();
  EXPECT_FALSE(solve_pnp_ransac(kinect_sensor(), same, {}, {}, 1).has_value());

  auto view = make_view(truth, 60, {}, random);
  for (size_t i = 0; i < 20; ++i) view[i].p_reference.x() = kNan;
  const auto solution = solve_pnp_ransac(kinect_sensor(), view, {}, {}, 1);
  ASSERT_TRUE(solution.has_value());
  EXPECT_EQ(solution->inlier_count, 40);
  EXPECT_LT(error_of(solution->T_reference_camera, truth).norm(), 1e-6);
}

}  // namespace
}  // namespace kinloop
