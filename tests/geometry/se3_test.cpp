#include "kinloop/geometry/se3.hpp"

#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

constexpr double kExact = 1e-12;

Eigen::Vector3d random_vector(Random& random, double deviation) {
  const double x = random.gaussian(), y = random.gaussian(), z = random.gaussian();
  return deviation * Eigen::Vector3d(x, y, z);
}

Vector6d twist_of(const Eigen::Vector3d& rho, const Eigen::Vector3d& omega) {
  Vector6d twist;
  twist << rho, omega;
  return twist;
}

double distance(const SE3& a, const SE3& b) {
  return (a.matrix() - b.matrix()).norm();
}

/// Twists with rotations from zero to just below half a turn, including those where formulas switch.
std::vector<Vector6d> test_twists() {
  Random random(11);
  std::vector<Vector6d> twists = {Vector6d::Zero()};
  for (const double angle :
       {1e-300, 1e-12, 1e-8, 0.99e-5, 1.01e-5, 1e-4, 1e-3, 0.1, 1.0, 2.0, 3.0, std::numbers::pi - 1e-6}) {
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector3d axis = random_vector(random, 1).normalized();
      twists.push_back(twist_of(random_vector(random, 2), angle * axis));
    }
  }
  return twists;
}

TEST(Skew, IsTheCrossProduct) {
  const Eigen::Vector3d a(1, 2, 3), b(-4, 0.5, 2);
  EXPECT_EQ(skew(a) * b, a.cross(b));
  EXPECT_EQ(skew(a).transpose(), -skew(a));
}

TEST(SO3, LogTakesBothQuaternionsOfARotationForOne) {
  for (const Vector6d& twist : test_twists()) {
    const Eigen::Quaterniond q = exp_so3(twist.tail<3>());
    EXPECT_LT((log_so3(q) - log_so3(Eigen::Quaterniond(-q.coeffs()))).norm(), kExact);
  }
}

TEST(SO3, HalfATurnHasAnAngleOfPi) {
  EXPECT_NEAR(log_so3(Eigen::Quaterniond(0, 1, 0, 0)).norm(), std::numbers::pi, kExact);
  EXPECT_NEAR(log_so3(exp_so3({0, 0, std::numbers::pi + 0.1})).norm(), std::numbers::pi - 0.1, kExact);
}

TEST(SE3, ExpIsTheMatrixExponential) {
  for (const Vector6d& twist : test_twists()) {
    Eigen::Matrix4d hat = Eigen::Matrix4d::Zero();
    hat.topLeftCorner<3, 3>() = skew(twist.tail<3>());
    hat.topRightCorner<3, 1>() = twist.head<3>();
    EXPECT_LT((SE3::exp(twist).matrix() - hat.exp()).norm(), 1e-13 * (1 + twist.norm())) << twist.transpose();
  }
}

TEST(SE3, LogAfterExpIsTheTwist) {
  for (const Vector6d& twist : test_twists()) {
    EXPECT_LT((SE3::exp(twist).log() - twist).norm(), 1e-9) << twist.transpose();
  }
}

TEST(SE3, SmallTwistsKeepFullPrecision) {
  for (const Vector6d& twist : test_twists()) {
    if (twist.tail<3>().norm() > 0.2) continue;
    EXPECT_LT((SE3::exp(twist).log() - twist).norm(), 1e-14 * (1 + twist.norm())) << twist.transpose();
  }
}

TEST(SE3, GroupLaws) {
  const auto twists = test_twists();
  const Eigen::Vector3d p(0.3, -2, 5);
  for (size_t i = 0; i + 2 < twists.size(); ++i) {
    const SE3 a = SE3::exp(twists[i]), b = SE3::exp(twists[i + 1]), c = SE3::exp(twists[i + 2]);
    EXPECT_LT(distance(a * a.inverse(), SE3{}), kExact);
    EXPECT_LT(distance(a.inverse() * a, SE3{}), kExact);
    EXPECT_LT(distance(a * SE3{}, a), kExact);
    EXPECT_LT(distance((a * b) * c, a * (b * c)), kExact);
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), kExact);
    EXPECT_LT(((a * b).matrix() - a.matrix() * b.matrix()).norm(), kExact);
    EXPECT_LT(distance(a.inverse(), SE3::exp(-twists[i])), kExact);
  }
}

TEST(SE3, AdjointMovesATwistToTheOtherSide) {
  const auto twists = test_twists();
  for (size_t i = 0; i + 1 < twists.size(); ++i) {
    const SE3 T = SE3::exp(twists[i]);
    const Vector6d x = 0.3 * twists[i + 1];
    EXPECT_LT(distance(T * SE3::exp(x), SE3::exp(T.adjoint() * x) * T), 1e-11);
  }
}

TEST(SE3, LongProductsStayRotations) {
  SE3 T;
  const SE3 step = SE3::exp(twist_of({0.01, 0, 0}, {0.01, 0.02, -0.03}));
  for (int i = 0; i < 100000; ++i) T = T * step;
  EXPECT_NEAR(T.rotation.norm(), 1, 1e-14);
  EXPECT_TRUE(T.is_finite());
}

TEST(SE3, FiniteMeansEveryNumberIs) {
  SE3 T;
  EXPECT_TRUE(T.is_finite());
  T.translation.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(T.is_finite());
  T = {};
  T.rotation.x() = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(T.is_finite());
}

TEST(Interpolate, EndsAndMiddle) {
  const auto twists = test_twists();
  for (size_t i = 0; i + 1 < twists.size(); ++i) {
    const SE3 a = SE3::exp(twists[i]), b = a * SE3::exp(0.9 * twists[i + 1]);
    EXPECT_LT(distance(interpolate(a, b, 0), a), kExact);
    EXPECT_LT(distance(interpolate(a, b, 1), b), 1e-9);
    const SE3 half = a.inverse() * interpolate(a, b, 0.5);
    EXPECT_LT(distance(a * half * half, b), 1e-9);
    EXPECT_LT(distance(interpolate(a, b, 0.3), interpolate(b, a, 0.7)), 1e-8);
  }
}

TEST(Interpolate, GoesOnBeyondTheEnds) {
  const SE3 a, b = SE3::exp(twist_of({1, 2, 3}, {0.1, -0.2, 0.3}));
  EXPECT_LT(distance(interpolate(a, b, 2), b * b), kExact);
  EXPECT_LT(distance(interpolate(a, b, -1), b.inverse()), kExact);
}

}  // namespace
}  // namespace kinloop
