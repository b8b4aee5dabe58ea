#include "kinloop/optimize/pose/ransac/rigid_ransac.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/optimize/synthetic_view.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

using test::error_of;
using test::kinect;
using test::kinect_sensor;
using test::kNan;
using test::random_motion;

/// Simulates the measurement of `p` by a camera with this noise.
/// A point before the camera.
Eigen::Vector3d anywhere(Random& random) {
  const double depth_m = random.uniform(0.7, 4);
  return kinect().unproject(test::random_pixel(random, kinect()), depth_m);
}

Eigen::Vector3d measured(const Eigen::Vector3d& p, double sigma_px, double sigma_inverse_depth,
                         Random& random) {
  const Eigen::Vector2d noise = test::gaussian_vector<2>(random);
  const double inverse = 1 / p.z() + sigma_inverse_depth * random.gaussian();
  return kinect().unproject(kinect().project(p) + sigma_px * noise, 1 / inverse);
}

std::vector<PointPair> make_pairs(const SE3& T_a_b, int count, double sigma_px, double sigma_inverse_depth,
                                  double outlier_fraction, Random& random) {
  std::vector<PointPair> pairs;
  while (static_cast<int>(pairs.size()) < count) {
    const Eigen::Vector3d p_b = anywhere(random);
    const Eigen::Vector3d p_a = T_a_b * p_b;
    if (p_a.z() < 0.3) continue;
    PointPair pair;
    pair.p_a = measured(p_a, sigma_px, sigma_inverse_depth, random);
    pair.p_b = measured(p_b, sigma_px, sigma_inverse_depth, random);
    if (sigma_px > 0) pair.sigma_a_px = pair.sigma_b_px = sigma_px;
    if (random.uniform() < outlier_fraction) {
      pair.p_a = anywhere(random);
    }
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(RigidRansac, RecoversTheTruthWithoutNoise) {
  Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const SE3 truth = random_motion(random, 0.5, 0.4);
    const auto pairs = make_pairs(truth, 50, 0, 0, 0, random);
    const auto solution = solve_rigid_ransac(kinect_sensor(), pairs, {}, 3);
    ASSERT_TRUE(solution.has_value());
    EXPECT_LT(error_of(solution->T_a_b, truth).norm(), 1e-8);
    EXPECT_EQ(solution->inlier_count, 50);
  }
}

TEST(RigidRansac, NormalisedErrorIsConsistent) {
  Random random(2);
  const RigidRansacOptions options;
  double sum = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const SE3 truth = random_motion(random, 0.5, 0.4);
    const auto pairs = make_pairs(truth, 80, 1.0, NoiseModel().point_pair.coefficient_per_m, 0, random);
    const auto solution = solve_rigid_ransac(kinect_sensor(), pairs, options, 3);
    ASSERT_TRUE(solution.has_value());
    const Vector6d error = error_of(solution->T_a_b, truth);
    sum += error.dot(solution->information * error);
  }
  EXPECT_NEAR(sum / kTrials, 6.0, 1.5);
}

TEST(RigidRansac, SurvivesSixtyPercentOutliers) {
  Random random(3);
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const SE3 truth = random_motion(random, 0.5, 0.4);
    const auto pairs = make_pairs(truth, 150, 0.8, 2e-3, 0.6, random);
    const auto solution = solve_rigid_ransac(kinect_sensor(), pairs, {}, seed);
    ASSERT_TRUE(solution.has_value());
    EXPECT_LT(error_of(solution->T_a_b, truth).norm(), 0.02);
    EXPECT_GT(solution->inlier_count, 40);
  }
}

TEST(RigidRansac, SameSeedSameResult) {
  Random random(4);
  const auto pairs = make_pairs(random_motion(random, 0.5, 0.4), 100, 1, 3e-3, 0.5, random);
  const auto first = solve_rigid_ransac(kinect_sensor(), pairs, {}, 8);
  const auto second = solve_rigid_ransac(kinect_sensor(), pairs, {}, 8);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->T_a_b.translation, second->T_a_b.translation);
  EXPECT_EQ(first->T_a_b.rotation.coeffs(), second->T_a_b.rotation.coeffs());
  EXPECT_EQ(first->inliers, second->inliers);
}

TEST(RigidRansac, RandomAndDegenerateInputsHaveNoSolution) {
  Random random(5);
  EXPECT_FALSE(solve_rigid_ransac(kinect_sensor(), {}, {}, 1).has_value());
  EXPECT_FALSE(
      solve_rigid_ransac(kinect_sensor(), make_pairs({}, 100, 1, 3e-3, 1.0, random), {}, 1).has_value());
  auto line = make_pairs({}, 40, 0, 0, 0, random);
  for (size_t i = 0; i < line.size(); ++i) {
    line[i].p_a = line[i].p_b = Eigen::Vector3d(0.02 * static_cast<double>(i), 0.1, 2.0);
  }
  EXPECT_FALSE(solve_rigid_ransac(kinect_sensor(), line, {}, 1).has_value());
}

TEST(RigidRansac, InvalidPairsAreIgnored) {
  Random random(6);
  const SE3 truth = random_motion(random, 0.5, 0.4);
  auto pairs = make_pairs(truth, 60, 0, 0, 0, random);
  pairs[0].p_a.x() = kNan;
  pairs[1].p_b.z() = 0;
  pairs[2].sigma_a_px = 0;
  pairs[3].p_b.y() = std::numeric_limits<double>::infinity();
  const auto solution = solve_rigid_ransac(kinect_sensor(), pairs, {}, 1);
  ASSERT_TRUE(solution.has_value());
  EXPECT_EQ(solution->inlier_count, 56);
  EXPECT_THAT(std::vector<uint8_t>(solution->inliers.begin(), solution->inliers.begin() + 4),
              testing::ElementsAre(0, 0, 0, 0));
}

TEST(RigidRansac, RefinementNeedsNoSamples) {
  Random random(7);
  const SE3 truth = random_motion(random, 0.5, 0.4);
  const auto pairs = make_pairs(truth, 60, 0, 0, 0, random);
  const auto solution = refine_rigid(kinect_sensor(), pairs, truth * random_motion(random, 0.002, 0.001), {});
  ASSERT_TRUE(solution.has_value());
  EXPECT_LT(error_of(solution->T_a_b, truth).norm(), 1e-8);
  EXPECT_FALSE(
      refine_rigid(kinect_sensor(), pairs, truth * SE3{Eigen::Quaterniond::Identity(), {5, 0, 0}}, {})
          .has_value());
}

}  // namespace
}  // namespace kinloop
