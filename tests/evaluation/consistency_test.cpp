#include "tools/evaluation/consistency.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

constexpr int kPoses = 2000;

SE3 true_pose(int i) {
  return {exp_so3({0.3, 0.002 * i, -0.1}), {0.01 * i, 0.2, -1}};
}

Matrix6d true_covariance() {
  Vector6d sigmas;
  sigmas << 0.01, 0.02, 0.03, 0.001, 0.002, 0.004;
  Matrix6d covariance = sigmas.cwiseAbs2().asDiagonal();
  covariance(0, 1) = covariance(1, 0) = 1e-4;
  return covariance;
}

Trajectory truth_in_another_frame() {
  const SE3 T_other_world{exp_so3({0.5, -0.4, 0.3}), {5, 6, 7}};
  Trajectory truth;
  for (int i = 0; i < kPoses; ++i) truth.push_back({i * 30'000'000LL, T_other_world * true_pose(i)});
  return truth;
}

std::vector<PoseWithCovariance> noisy_poses(double promised_share_of_covariance) {
  const Eigen::LLT<Matrix6d> factor(true_covariance());
  Random random(3);
  std::vector<PoseWithCovariance> poses;
  for (int i = 0; i < kPoses; ++i) {
    Vector6d noise;
    for (double& x : noise) x = random.gaussian();
    const SE3 off = i == 0 ? SE3{} : SE3::exp(factor.matrixL() * noise);
    poses.push_back({i * 30'000'000LL, true_pose(i) * off, promised_share_of_covariance * true_covariance()});
  }
  return poses;
}

TEST(Consistency, IsThreeForCorrectCovariances) {
  const auto found = evaluate_consistency(noisy_poses(1), truth_in_another_frame());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->poses, static_cast<size_t>(kPoses - 1));
  EXPECT_NEAR(found->nees_translation, 3, 0.2);
  EXPECT_NEAR(found->nees_rotation, 3, 0.2);
  EXPECT_GT(found->within_4_sigma, 0.998);
}

TEST(Consistency, IsLargerForOverconfidentCovariances) {
  const auto found = evaluate_consistency(noisy_poses(0.25), truth_in_another_frame());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->nees_translation, 12, 0.8);
  EXPECT_LT(found->within_4_sigma, 0.97);
}

TEST(Consistency, PosesThatNothingMeasuresDoNotCount) {
  auto poses = noisy_poses(1);
  poses[1].covariance.setZero();
  poses[2].covariance.diagonal().setConstant(std::numeric_limits<double>::infinity());
  poses[3].covariance.setConstant(std::numeric_limits<double>::quiet_NaN());
  const auto found = evaluate_consistency(poses, truth_in_another_frame());
  ASSERT_TRUE(found);
  EXPECT_EQ(found->poses, static_cast<size_t>(kPoses - 4));
}

TEST(Consistency, IsEmptyWithoutGroundTruth) {
  EXPECT_FALSE(evaluate_consistency({}, truth_in_another_frame()));
  EXPECT_FALSE(evaluate_consistency(noisy_poses(1), {}));
}

}  // namespace
}  // namespace kinloop
