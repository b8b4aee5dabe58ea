#include "kinloop/geometry/rigid_alignment.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

using Points = std::vector<Eigen::Vector3d>;

const SE3 kTruth{exp_so3({0.4, -1.9, 0.7}), {1.5, -0.3, 12}};  // T_a_b

Eigen::Vector3d gaussian3(Random& random) {
  const double x = random.gaussian(), y = random.gaussian(), z = random.gaussian();
  return {x, y, z};
}

Points random_points(size_t count, uint64_t seed, const Eigen::Vector3d& spread = {1, 2, 3}) {
  Random random(seed);
  Points points(count);
  for (auto& p : points) p = gaussian3(random).cwiseProduct(spread) + Eigen::Vector3d(5, 0, -7);
  return points;
}

Points moved(const SE3& T, const Points& points) {
  Points out;
  for (const auto& p : points) out.push_back(T * p);
  return out;
}

double error_of(const std::optional<SE3>& estimate) {
  return estimate ? (kTruth.inverse() * *estimate).log().norm() : 1e9;
}

double cost(const SE3& T, const Points& a, const Points& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - T * b[i]).squaredNorm();
  return sum;
}

TEST(AlignRigid, ExactPointsGiveTheExactMotion) {
  for (const size_t count : {3, 4, 10, 500}) {
    const Points b = random_points(count, count);
    EXPECT_LT(error_of(align_rigid(moved(kTruth, b), b)), 1e-11) << count;
  }
}

TEST(AlignRigid, CoplanarPointsGiveARotationNotAReflection) {
  const Points b = random_points(20, 3, {1, 2, 0});
  const auto T = align_rigid(moved(kTruth, b), b);
  EXPECT_LT(error_of(T), 1e-11);
  EXPECT_NEAR(T->R().determinant(), 1, 1e-12);
}

TEST(AlignRigid, MirroredPointsGiveARotationAllTheSame) {
  const Points b = random_points(20, 3);
  Points mirrored = b;
  for (auto& p : mirrored) p.x() = -p.x();
  const auto T = align_rigid(mirrored, b);
  ASSERT_TRUE(T);
  EXPECT_NEAR(T->R().determinant(), 1, 1e-12);
}

TEST(AlignRigid, HalfTurnsAreNoSpecialCase) {
  const SE3 half_turn{Eigen::Quaterniond(0, 0, 1, 0), {1, 2, 3}};
  const Points b = random_points(10, 4);
  const auto T = align_rigid(moved(half_turn, b), b);
  ASSERT_TRUE(T);
  EXPECT_LT((T->matrix() - half_turn.matrix()).norm(), 1e-11);
}

TEST(AlignRigid, NoiseAveragesOutAndNoNeighbourIsBetter) {
  Random random(9);
  const Points b = random_points(2000, 5);
  Points a = moved(kTruth, b);
  for (auto& p : a) p += 0.01 * gaussian3(random);
  const auto T = align_rigid(a, b);
  ASSERT_TRUE(T);
  EXPECT_LT(kTruth.inverse().rotation.angularDistance(T->inverse().rotation), 1e-3);
  EXPECT_LT((kTruth * b[0] - *T * b[0]).norm(), 3e-3);
  const double best = cost(*T, a, b);
  for (int k = 0; k < 6; ++k) {
    for (const double step : {-1e-4, 1e-4})
      EXPECT_GT(cost(*T * SE3::exp(step * Vector6d::Unit(k)), a, b), best);
  }
}

TEST(AlignRigid, WeightsOfZeroSilenceOutliers) {
  const Points b = random_points(10, 6);
  Points a = moved(kTruth, b);
  a[3] += Eigen::Vector3d(100, 0, 0);
  std::vector<double> weights(10, 2.5);
  weights[3] = 0;
  EXPECT_LT(error_of(align_rigid(a, b, weights)), 1e-11);
  EXPECT_GT(error_of(align_rigid(a, b)), 1e-2);
}

TEST(AlignRigid, AWeightOfTwoIsAPairGivenTwice) {
  Random random(9);
  Points b = random_points(10, 6);
  Points a = moved(kTruth, b);
  for (auto& p : a) p += 0.1 * gaussian3(random);
  std::vector<double> weights(10, 1);
  weights[0] = 2;
  const auto weighted = align_rigid(a, b, weights);
  a.push_back(a[0]);
  b.push_back(b[0]);
  const auto doubled = align_rigid(a, b);
  ASSERT_TRUE(weighted && doubled);
  EXPECT_LT((weighted->matrix() - doubled->matrix()).norm(), 1e-12);
}

TEST(AlignRigid, WhatDoesNotFixTheRotationGivesNothing) {
  const auto align_with_itself = [](const Points& points) { return align_rigid(points, points); };
  EXPECT_FALSE(align_with_itself({}));
  EXPECT_FALSE(align_with_itself(random_points(2, 1)));
  EXPECT_FALSE(align_with_itself(Points(5, Eigen::Vector3d(0.1, 0.2, 0.3))));
  Points line;
  for (int i = 0; i < 10; ++i) line.emplace_back(0.1 * i, 0.3 * i, -0.7 * i);
  EXPECT_FALSE(align_with_itself(line));
  EXPECT_FALSE(align_rigid(moved(kTruth, line), line));
}

TEST(AlignRigid, NumbersThatAreNoneGiveNothing) {
  Points b = random_points(5, 1);
  const Points a = b;
  b[2].x() = std::nan("");
  EXPECT_FALSE(align_rigid(a, b));
  EXPECT_FALSE(align_rigid(a, a, std::vector<double>(5, 0.0)));
  EXPECT_FALSE(align_rigid(a, a, std::vector<double>(5, std::nan(""))));
}

TEST(AlignRigid, UnequalSizesAreABrokenPromise) {
  const Points five = random_points(5, 1), four = random_points(4, 1);
  EXPECT_THROW(align_rigid(five, four), std::logic_error);
  EXPECT_THROW(align_rigid(five, five, std::vector<double>(4, 1.0)), std::logic_error);
}

}  // namespace
}  // namespace kinloop
