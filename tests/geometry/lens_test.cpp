#include "kinloop/geometry/lens.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {
namespace {

struct Device {
  std::string name;
  PinholeCamera camera;
};

void PrintTo(const Device& device, std::ostream* stream) {
  *stream << device.name;
}

PinholeCamera camera_with(int width, int height, const Eigen::Vector4d& fx_fy_cx_cy, LensModel model,
                          const std::vector<double>& coefficients) {
  const Eigen::Vector4d& k = fx_fy_cx_cy;
  return {width, height, k(0), k(1), k(2), k(3), lens_with(model, coefficients)};
}

std::vector<Device> devices() {
  using enum LensModel;
  const std::vector<double> azure_depth = {3.1305770, 2.3249390, 8.13217e-05, -5.11557e-05,
                                           0.1304156, 3.4586515, 3.3501145,   0.6629416};
  return {
      {"kinect1", camera_with(640, 480, {517.3, 516.5, 318.6, 255.3}, kBrownConrady,
                              {0.262383, -0.953104, -0.005358, 0.002628, 1.163314})},
      {"iphone_wide",
       camera_with(1920, 1440, {1450, 1450, 960, 720}, kBrownConrady, {0.12, -0.32, 0.0006, -0.0009, 0.24})},
      {"azure_color", camera_with(1280, 720, {612.1, 611.9, 637.8, 367.5}, kRational,
                                  {0.5843808, -2.4942491, 0.0006530, -0.0001765, 1.3602830, 0.4647552,
                                   -2.3362464, 1.3011596})},
      {"azure_nfov", camera_with(640, 576, {503.9, 504, 332, 326}, kRational, azure_depth)},
      {"azure_wfov", camera_with(1024, 1024, {503.9, 504, 524, 506}, kRational, azure_depth)},
      {"t265", camera_with(848, 800, {286.2, 286.3, 417.6, 400.5}, kKannalaBrandt,
                           {-0.0065, 0.0421, -0.0396, 0.0069})},
      {"fisheye160",
       camera_with(1280, 960, {560, 561, 644, 478}, kKannalaBrandt, {0.02, -0.015, 0.004, -0.0007})},
  };
}

cv::Matx33d matrix(const PinholeCamera& c) {
  return {c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1};
}

bool is_fisheye(const PinholeCamera& c) {
  return c.lens.model == LensModel::kKannalaBrandt;
}

/// Pixels of the whole image within `max_degrees` of the axis, and the ideal points of their rays.
struct Samples {
  std::vector<cv::Point2d> raw, ideal;
};

Samples samples_of(const PinholeCamera& c, double max_degrees) {
  const double max_radius = std::tan(max_degrees * M_PI / 180);
  Samples samples;
  for (double v = 0; v < c.height; v += c.height / 24.0) {
    for (double u = 0; u < c.width; u += c.width / 32.0) {
      const Eigen::Vector2d p = c.lens.undistort({(u - c.cx) / c.fx, (v - c.cy) / c.fy});
      if (p.norm() > max_radius) continue;
      samples.raw.emplace_back(u, v);
      samples.ideal.emplace_back(p.x(), p.y());
    }
  }
  EXPECT_GT(samples.ideal.size(), 500U);
  return samples;
}

class LensOfADevice : public testing::TestWithParam<Device> {};

TEST_P(LensOfADevice, HasTheJacobianOfItsDistortion) {
  const PinholeCamera& c = GetParam().camera;
  for (const auto& ideal : samples_of(c, 80).ideal) {
    const Eigen::Vector2d pixel(c.fx * ideal.x + c.cx, c.fy * ideal.y + c.cy);
    const double step = 1e-3 * (1 + (pixel - Eigen::Vector2d(c.cx, c.cy)).norm() / c.fx);
    Eigen::Matrix2d numeric;
    for (int axis = 0; axis < 2; ++axis) {
      const Eigen::Vector2d d = step * Eigen::Vector2d::Unit(axis);
      numeric.col(axis) = (c.distort(pixel + d) - c.distort(pixel - d)) / (2 * step);
    }
    EXPECT_LT((c.distort_jacobian(pixel) - numeric).cwiseAbs().maxCoeff(), 1e-5) << pixel.transpose();
  }
}

TEST_P(LensOfADevice, DistortsAsOpenCv) {
  const PinholeCamera& c = GetParam().camera;
  const Samples samples = samples_of(c, 80);
  ASSERT_GT(samples.ideal.size(), 500U);
  std::vector<cv::Point3d> points;
  for (const auto& p : samples.ideal) points.emplace_back(2 * p.x, 2 * p.y, 2);
  std::vector<cv::Point2d> pixels;
  const auto zero = cv::Vec3d::all(0);
  if (is_fisheye(c)) {
    cv::fisheye::projectPoints(points, pixels, zero, zero, matrix(c), lens_coefficients(c.lens));
  } else {
    cv::projectPoints(points, zero, zero, matrix(c), lens_coefficients(c.lens), pixels);
  }
  for (size_t i = 0; i < pixels.size(); ++i) {
    const Eigen::Vector2d own = c.distort(c.project({points[i].x, points[i].y, points[i].z}));
    ASSERT_LT((own - Eigen::Vector2d(pixels[i].x, pixels[i].y)).norm(), 1e-6);
  }
}

TEST_P(LensOfADevice, UndistortsAsOpenCv) {
  const PinholeCamera& c = GetParam().camera;
  const Samples samples = samples_of(c, 80);
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 5000, 1e-14);
  std::vector<cv::Point2d> ideal;
  if (is_fisheye(c)) {
    cv::fisheye::undistortPoints(samples.raw, ideal, matrix(c), lens_coefficients(c.lens));
  } else {
    cv::undistortPoints(samples.raw, ideal, matrix(c), lens_coefficients(c.lens), cv::noArray(),
                        cv::noArray(), until);
  }
  for (size_t i = 0; i < ideal.size(); ++i) {
    // Compared in the image: far from the axis of a fisheye lens ideal pixels are larger than images.
    const Eigen::Vector2d opencv = c.distort({c.fx * ideal[i].x + c.cx, c.fy * ideal[i].y + c.cy});
    const Eigen::Vector2d own =
        c.distort({c.fx * samples.ideal[i].x + c.cx, c.fy * samples.ideal[i].y + c.cy});
    ASSERT_LT((own - opencv).norm(), 1e-6) << samples.raw[i];
  }
}

TEST_P(LensOfADevice, DistortInvertsUndistort) {
  const PinholeCamera& c = GetParam().camera;
  const Samples samples = samples_of(c, 89);
  for (const auto& raw : samples.raw) {
    const Eigen::Vector2d pixel(raw.x, raw.y);
    ASSERT_LT((c.distort(c.undistort(pixel)) - pixel).norm(), 1e-9) << raw;
  }
}

TEST_P(LensOfADevice, SelfCalibrationCanAdjustItsLinearTerms) {
  const LensDistortion& lens = GetParam().camera.lens;
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(0, 0), {0.3, -0.2}, {-0.5, 0.4}}) {
    LensDistortion other = lens;
    Eigen::Matrix<double, LinearDistortion::kTerms, 1> k;
    k << 0.1, -0.2, 0.01, 0.02, 0.05;
    set_linear_coefficients(other, k);
    const LinearDistortion linear = linear_distortion(lens, p);
    const Eigen::Vector2d expected =
        linear.constant + Eigen::Vector2d(linear.along_x.dot(k), linear.along_y.dot(k));
    EXPECT_LT((other.distort(p) - expected).norm(), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, LensOfADevice, testing::ValuesIn(devices()),
                         [](const auto& device) { return device.param.name; });

TEST(LensDistortion, TheAxisStaysInPlace) {
  for (const Device& device : devices()) {
    EXPECT_EQ(device.camera.lens.distort({0, 0}), Eigen::Vector2d(0, 0)) << device.name;
    EXPECT_EQ(device.camera.lens.undistort({0, 0}), Eigen::Vector2d(0, 0)) << device.name;
  }
}

TEST(LensDistortion, AFisheyeWithoutCoefficientsIsEquidistant) {
  LensDistortion lens;
  EXPECT_TRUE(lens.is_identity());
  lens.model = LensModel::kKannalaBrandt;
  EXPECT_FALSE(lens.is_identity());
  const double angle = 1.2;
  EXPECT_NEAR(lens.distort({std::tan(angle), 0}).x(), angle, 1e-15);
  EXPECT_NEAR(lens.undistort({0, angle}).y(), std::tan(angle), 1e-12);
}

TEST(LensDistortion, BeyondTheFieldOfViewIsItsLimit) {
  LensDistortion barrel;
  barrel.k1 = -0.3;  // r (1 - 0.3 r^2) turns back at r = 1.054, where it is 0.703
  const double limit = std::sqrt(1 / 0.9);
  EXPECT_NEAR(barrel.undistort({0.70, 0}).x(), 1.0, 0.06);
  for (const double beyond : {0.71, 1.0, 5.0, 1e6}) {
    const Eigen::Vector2d p = barrel.undistort(beyond * Eigen::Vector2d(0.6, 0.8));
    EXPECT_NEAR(p.norm(), limit, 0.06) << beyond;
    EXPECT_NEAR(p.y() / p.x(), 0.8 / 0.6, 1e-12) << beyond;
  }
  LensDistortion fisheye;
  fisheye.model = LensModel::kKannalaBrandt;
  EXPECT_NEAR(fisheye.undistort({2, 0}).x(), LensDistortion::kMaxRadius, 1e-6);  // 115 degrees
}

TEST(LensDistortion, NoCoefficientsHangOrGiveNaN) {
  Random random(5);
  for (int trial = 0; trial < 3000; ++trial) {
    const auto model = static_cast<LensModel>(trial % 3);
    const double scale = std::pow(10, random.uniform(-3, 2));
    std::vector<double> coefficients = lens_coefficients({model});
    for (double& c : coefficients) c = scale * random.uniform(-1, 1);
    const LensDistortion lens = lens_with(model, coefficients);
    for (const double radius : {0.0, 1e-12, 0.1, 1.0, 3.0, 30.0, 1e4}) {
      const double side = random.uniform(0, 6.3);
      const Eigen::Vector2d p = radius * Eigen::Vector2d(std::cos(side), std::sin(side));
      ASSERT_TRUE(lens.distort(p).allFinite()) << name_of(model) << " " << trial << " " << radius;
      const Eigen::Vector2d ideal = lens.undistort(p);
      ASSERT_TRUE(ideal.allFinite()) << name_of(model) << " " << trial << " " << radius;
      ASSERT_LE(ideal.norm(), LensDistortion::kMaxRadius * (1 + 1e-12));
    }
  }
}

TEST(LensDistortion, CoefficientsAreInTheOrderOfOpenCv) {
  const std::vector<double> eight = {1, 2, 3, 4, 5, 6, 7, 8};
  const LensDistortion lens = lens_with(LensModel::kRational, eight);
  EXPECT_EQ(lens.p1, 3);
  EXPECT_EQ(lens.k3, 5);
  EXPECT_EQ(lens.k6, 8);
  EXPECT_EQ(lens_coefficients(lens), eight);
  const LensDistortion fisheye = lens_with(LensModel::kKannalaBrandt, std::vector<double>{1, 2, 3, 4});
  EXPECT_EQ(fisheye.k3, 3);
  EXPECT_EQ(fisheye.k4, 4);
}

}  // namespace
}  // namespace kinloop
