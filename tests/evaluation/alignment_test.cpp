#include "tools/evaluation/alignment.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

using Poses = std::vector<SE3>;

/// Cameras that turn on their way; `extent` scales the path along each axis.
Poses path(const Eigen::Vector3d& extent) {
  Poses poses;
  for (int i = 0; i < 100; ++i) {
    const double t = 0.1 * i;
    const Eigen::Vector3d curve(t, std::sin(t), std::cos(2 * t));
    poses.push_back({exp_so3({0.2 * std::sin(t), 0.1 * t, 0.3}), extent.cwiseProduct(curve)});
  }
  return poses;
}

/// The poses in a world b with a = S_a_b b.
Poses seen_from(const Similarity& S_a_b, const Poses& poses) {
  Poses seen;
  for (const SE3& pose : poses) {
    SE3 rigid = S_a_b.T.inverse() * pose;
    rigid.translation /= S_a_b.scale;
    seen.push_back(rigid);
  }
  return seen;
}

void expect_recovered(const Similarity& expected, const Eigen::Vector3d& extent, Alignment alignment) {
  const Poses a = path(extent);
  const auto found = align_poses(a, seen_from(expected, a), alignment);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->scale, expected.scale, 1e-9);
  EXPECT_LT((found->T * expected.T.inverse()).log().norm(), 1e-6);
}

const Eigen::Vector3d kCurve(1, 1, 1), kLine(1, 0, 0), kPlace(0, 0, 0);
const SE3 kMotion{exp_so3({0.4, -1.1, 0.7}), {3, -2, 5}};
const SE3 kTurn{exp_so3({0, 0, 2.5}), {3, -2, 5}};

TEST(AlignPoses, RecoversTheMotionBetweenTheWorlds) {
  expect_recovered({1, kMotion}, kCurve, Alignment::kSe3);
  expect_recovered({1, kMotion}, kCurve, Alignment::kSim3);
  expect_recovered({0.25, kMotion}, kCurve, Alignment::kSim3);
  expect_recovered({1, kTurn}, kCurve, Alignment::kYaw);
  expect_recovered({1, {}}, kCurve, Alignment::kNone);
}

TEST(AlignPoses, OnALineTheOrientationsDecideOnTheRotationAboutIt) {
  expect_recovered({1, kMotion}, kLine, Alignment::kSe3);
  expect_recovered({3, kMotion}, kLine, Alignment::kSim3);
  expect_recovered({1, kTurn}, kLine, Alignment::kYaw);
}

TEST(AlignPoses, InOnePlaceTheOrientationsDecide) {
  expect_recovered({1, kMotion}, kPlace, Alignment::kSe3);
  expect_recovered({1, kTurn}, kPlace, Alignment::kYaw);
  EXPECT_FALSE(align_poses(path(kPlace), path(kPlace), Alignment::kSim3));
}

TEST(AlignPoses, OnALineWithNoiseIsTheLeastSquaresSolution) {
  Random random(7);
  const Poses a = path(kLine);
  Poses b = seen_from({1, kMotion}, a);
  for (SE3& pose : b) pose.translation += 0.01 * test::gaussian_vector<3>(random);
  const auto found = align_poses(a, b, Alignment::kSe3);
  ASSERT_TRUE(found);
  const auto error = [&](const SE3& T) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += (T * b[i].translation - a[i].translation).squaredNorm();
    return sum;
  };
  for (int k = 0; k < 50; ++k) {
    Vector6d twist;
    for (double& x : twist) x = 0.01 * random.gaussian();
    EXPECT_GE(error(SE3::exp(twist) * found->T), error(found->T));
  }
}

TEST(AlignPoses, YawLeavesTheVerticalAlone) {
  const Poses a = path(kCurve);
  const auto found = align_poses(a, seen_from({1, kMotion}, a), Alignment::kYaw);
  ASSERT_TRUE(found);
  EXPECT_LT((found->T.R() * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(AlignPoses, NeedsThreePairs) {
  const Poses two(2), three(3);
  for (const Alignment alignment : {Alignment::kSe3, Alignment::kYaw, Alignment::kNone}) {
    EXPECT_FALSE(align_poses(two, two, alignment));
    EXPECT_TRUE(align_poses(three, three, alignment));
  }
}

}  // namespace
}  // namespace kinloop
