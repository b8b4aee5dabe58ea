#include "kinloop/geometry/camera.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/sensor/camera/possible_camera.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop {
namespace {

PinholeCamera freiburg1() {
  PinholeCamera c;
  c.width = 640, c.height = 480;
  c.fx = 517.306408, c.fy = 516.469215, c.cx = 318.643040, c.cy = 255.313989;
  c.lens.k1 = 0.262383, c.lens.k2 = -0.953104, c.lens.p1 = -0.005358, c.lens.p2 = 0.002628,
  c.lens.k3 = 1.163314;
  return c;
}

PinholeCamera freiburg2() {
  PinholeCamera c;
  c.width = 640, c.height = 480;
  c.fx = 520.908620, c.fy = 521.007327, c.cx = 325.141442, c.cy = 249.701764;
  c.lens.k1 = 0.231222, c.lens.k2 = -0.784899, c.lens.p1 = -0.003257, c.lens.p2 = -0.000105,
  c.lens.k3 = 0.917205;
  return c;
}

PinholeCamera without_distortion(PinholeCamera c) {
  c.lens = {};
  return c;
}

/// Brown's model as in the OpenCV manual, independent of the code under test.
Eigen::Vector2d distort_by_the_book(const PinholeCamera& c, const Eigen::Vector2d& pixel) {
  const double x = (pixel.x() - c.cx) / c.fx, y = (pixel.y() - c.cy) / c.fy;
  const double r = std::hypot(x, y);
  const double radial =
      1 + c.lens.k1 * std::pow(r, 2) + c.lens.k2 * std::pow(r, 4) + c.lens.k3 * std::pow(r, 6);
  const double xd = x * radial + 2 * c.lens.p1 * x * y + c.lens.p2 * (r * r + 2 * x * x);
  const double yd = y * radial + c.lens.p1 * (r * r + 2 * y * y) + 2 * c.lens.p2 * x * y;
  return {c.fx * xd + c.cx, c.fy * yd + c.cy};
}

class RealCamera : public testing::TestWithParam<PinholeCamera> {};

TEST_P(RealCamera, ProjectAfterUnprojectIsThePixel) {
  const PinholeCamera& c = GetParam();
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector2d pixel = test::uniform_vector<2>(random, {0, 0}, {639, 479});
    const double depth_m = random.uniform(0.3, 10);
    const Eigen::Vector3d p = c.unproject(pixel, depth_m);
    EXPECT_EQ(p.z(), depth_m);
    EXPECT_LT((c.project(p) - pixel).norm(), 1e-10);
  }
}

TEST_P(RealCamera, DistortIsTheBrownModel) {
  const PinholeCamera& c = GetParam();
  for (int v = -20; v < 500; v += 13) {
    for (int u = -20; u < 660; u += 17) {
      const Eigen::Vector2d pixel(u, v);
      EXPECT_LT((c.distort(pixel) - distort_by_the_book(c, pixel)).norm(), 1e-9);
    }
  }
}

TEST_P(RealCamera, UndistortInvertsDistortOverTheWholeImage) {
  const PinholeCamera& c = GetParam();
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      const Eigen::Vector2d raw(u, v);
      ASSERT_LT((c.distort(c.undistort(raw)) - raw).norm(), 1e-7) << u << " " << v;
    }
  }
}

TEST_P(RealCamera, JacobianIsTheNumericDerivative) {
  const PinholeCamera& c = GetParam();
  Random random(2);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p = test::uniform_vector<3>(random, {-2, -2, 0.5}, {2, 2, 6});
    Eigen::Matrix<double, 2, 3> numeric;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      numeric.col(k) = (c.project(p + step) - c.project(p - step)) / (2 * kStep);
    }
    const auto analytic = c.project_jacobian(p);
    EXPECT_LT((analytic - numeric).norm(), 1e-6 * (1 + analytic.norm()));
  }
}

std::string preset_name(const testing::TestParamInfo<PinholeCamera>& info) {
  const std::vector<std::string> names = {"freiburg1", "freiburg2", "without_distortion"};
  return names.at(info.index);
}

INSTANTIATE_TEST_SUITE_P(Presets, RealCamera,
                         testing::Values(freiburg1(), freiburg2(), without_distortion(freiburg1())),
                         preset_name);

TEST(PinholeCamera, UndistortFindsTheNearSolution) {
  // The undistorted image of a real lens is the raw one, slightly deformed: no pixel changes to another
  // branch.
  const PinholeCamera c = freiburg1();
  for (int v = 0; v < c.height; v += 7) {
    for (int u = 0; u < c.width; u += 7) {
      EXPECT_LT((c.undistort({u, v}) - Eigen::Vector2d(u, v)).norm(), 40);
    }
  }
}

TEST(PinholeCamera, NeighboursStayNeighboursAndInOrder) {
  const PinholeCamera c = freiburg1();
  for (int v = 0; v < c.height; v += 5) {
    for (int u = 1; u < c.width; ++u) {
      const double step = c.undistort({u, v}).x() - c.undistort({u - 1, v}).x();
      ASSERT_GT(step, 0.5) << u << " " << v;
      ASSERT_LT(step, 1.5) << u << " " << v;
    }
  }
}

TEST(PinholeCamera, WithoutDistortionPixelsStayBitByBit) {
  const PinholeCamera c = without_distortion(freiburg1());
  const Eigen::Vector2d pixel(12.345678, 400.1);
  EXPECT_FALSE(c.has_distortion());
  EXPECT_EQ(c.distort(pixel), pixel);
  EXPECT_EQ(c.undistort(pixel), pixel);
}

TEST(PinholeCamera, OneCoefficientIsDistortion) {
  using Lens = LensDistortion;
  for (double Lens::*k : {&Lens::k1, &Lens::k2, &Lens::p1, &Lens::p2, &Lens::k3}) {
    PinholeCamera c = without_distortion(freiburg1());
    c.lens.*k = 0.01;
    EXPECT_TRUE(c.has_distortion());
    EXPECT_NE(c.distort({0, 0}), Eigen::Vector2d(0, 0));
  }
}

TEST(PinholeCamera, ALensNoOneBuildsStillGivesNumbers) {
  PinholeCamera c = freiburg1();
  c.lens.k1 = -50, c.lens.k2 = 900;
  for (int u = 0; u < 640; u += 40) EXPECT_TRUE(c.undistort({u, u * 0.75}).allFinite());
}

TEST(PinholeCamera, HasNoMorePixelsThanADecodedImage) {
  PinholeCamera c = freiburg1();
  c.width = c.height = 8192;
  c.fx = c.fy = 8000;
  EXPECT_TRUE(is_possible(c));
  c.height = 8193;
  EXPECT_FALSE(is_possible(c));
}

TEST(PinholeCamera, ContainsTheCentresOfItsPixels) {
  const PinholeCamera c = freiburg1();
  EXPECT_TRUE(c.contains({0, 0}));
  EXPECT_TRUE(c.contains({639, 479}));
  EXPECT_FALSE(c.contains({639.01, 100}));
  EXPECT_FALSE(c.contains({100, -0.01}));
  EXPECT_TRUE(c.contains({10, 10}, 10));
  EXPECT_FALSE(c.contains({9.9, 10}, 10));
  EXPECT_FALSE(c.contains({100, 469.5}, 10));
  EXPECT_FALSE(c.contains({std::nan(""), 10}));
}

}  // namespace
}  // namespace kinloop
