#include "kinloop/features/extraction/extractor.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "kinloop/features/extraction/corner_detector.hpp"
#include "kinloop/features/extraction/surf.hpp"
#include "kinloop/features/hamming.hpp"
#include "kinloop/features/matcher.hpp"
#include "tests/features/cluttered_image.hpp"

namespace kinloop {
namespace {

using test::cluttered_image;
using test::ideal_camera;

TEST(Extractor, GivesOneEntryPerKeypoint) {
  const Features f = extract_features(cluttered_image(1), cv::Mat(), Sensor{ideal_camera()}, {});
  EXPECT_GT(f.size(), 700U);
  EXPECT_LE(f.size(), 1010U);
  EXPECT_EQ(f.raw_pixels.size(), f.size());
  EXPECT_EQ(f.depths_m.size(), f.size());
  EXPECT_EQ(f.levels.size(), f.size());
  EXPECT_EQ(f.angles_rad.size(), f.size());
  EXPECT_EQ(f.sigmas_px.size(), f.size());
  EXPECT_EQ(f.descriptors.rows, static_cast<int>(f.size()));
  EXPECT_EQ(f.descriptors.cols, 32);
}

TEST(Extractor, SpreadsOverDimAndBrightPartsMoreThanOpenCv) {
  cv::Mat image = cluttered_image(2);
  cv::Mat right = image.colRange(320, 640);  // a quarter of the contrast of the left half: double it
  right.convertTo(right, CV_8U, 2);
  const Features f = extract_features(image, cv::Mat(), Sensor{ideal_camera()}, {});
  const auto ours =
      std::count_if(f.pixels.begin(), f.pixels.end(), [](const auto& p) { return p.x() > 320; });
  std::vector<cv::KeyPoint> points;
  cv::ORB::create(1000)->detect(image, points);
  const auto theirs = std::count_if(points.begin(), points.end(), [](const auto& p) { return p.pt.x > 320; });
  EXPECT_GT(ours, static_cast<long>(f.size() * 15 / 100));
  EXPECT_GT(ours, 2 * theirs);
}

/// Levels are described separately, each as cv::ORB describes an independent image.
TEST(Extractor, DescribesEveryLevelAsOpenCvDoes) {
  const cv::Mat image = cluttered_image(3);
  const FeatureOptions options;
  const auto pyramid = build_pyramid(image, options);
  const auto corners = detect_corners(pyramid, options);
  const Features f = extract_features(image, cv::Mat(), Sensor{ideal_camera()}, options);
  ASSERT_EQ(f.size(), corners.size());
  int compared = 0;
  for (int level = 0; level < static_cast<int>(pyramid.size()); ++level) {
    std::vector<cv::KeyPoint> points;
    for (size_t i = 0; i < corners.size(); ++i) {
      if (corners[i].level != level) continue;
      points.emplace_back(static_cast<float>(corners[i].x), static_cast<float>(corners[i].y), 31.0F,
                          corners[i].angle_deg, 1.0F, 0, static_cast<int>(i));
    }
    cv::Mat expected;
    cv::ORB::create(1000, 1.2F, 1)->compute(pyramid[static_cast<size_t>(level)], points, expected);
    for (size_t k = 0; k < points.size(); ++k, ++compared) {  // without those that OpenCV finds near the edge
      EXPECT_EQ(cv::norm(expected.row(static_cast<int>(k)), f.descriptors.row(points[k].class_id),
                         cv::NORM_HAMMING),
                0);
    }
  }
  EXPECT_GT(compared, 700);
}

TEST(Extractor, FindsTheSameCornersInAShiftedImage) {
  const cv::Mat image = cluttered_image(4);
  cv::Mat shifted;
  const cv::Matx23d shift(1, 0, 7, 0, 1, 5);
  cv::warpAffine(image, shifted, shift, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  const Features a = extract_features(image, cv::Mat(), Sensor{ideal_camera()}, {});
  const Features b = extract_features(shifted, cv::Mat(), Sensor{ideal_camera()}, {});
  int repeated = 0;
  for (const auto& pixel : a.pixels) {
    repeated +=
        std::any_of(b.pixels.begin(), b.pixels.end(),
                    [&](const auto& other) { return (other - pixel - Eigen::Vector2f(7, 5)).norm() < 2; })
            ? 1
            : 0;
  }
  EXPECT_GT(repeated, static_cast<int>(a.size() * 7 / 10));
}

/// Fraction of the corners redetected within `radius_px` of their position under `H`, among those that stay
/// in the image.
double repeatability(const Features& a, const Features& b, const cv::Matx33d& H, float radius_px) {
  int visible = 0, repeated = 0;
  for (const auto& pixel : a.pixels) {
    const cv::Vec3d moved = H * cv::Vec3d(pixel.x(), pixel.y(), 1);
    const Eigen::Vector2f at(static_cast<float>(moved[0] / moved[2]),
                             static_cast<float>(moved[1] / moved[2]));
    if (at.x() < 30 || at.y() < 30 || at.x() > 610 || at.y() > 450) continue;
    ++visible;
    repeated += std::any_of(b.pixels.begin(), b.pixels.end(),
                            [&](const auto& other) { return (other - at).norm() < radius_px; })
                    ? 1
                    : 0;
  }
  EXPECT_GT(visible, 300);
  return static_cast<double>(repeated) / visible;
}

TEST(Extractor, FindsTheSameCornersInATurnedAndScaledImage) {
  const cv::Mat image = cluttered_image(8);
  const cv::Mat turn = cv::getRotationMatrix2D({320, 240}, 20, 0.8);
  const cv::Matx33d H(turn.at<double>(0, 0), turn.at<double>(0, 1), turn.at<double>(0, 2),
                      turn.at<double>(1, 0), turn.at<double>(1, 1), turn.at<double>(1, 2), 0, 0, 1);
  cv::Mat turned;
  cv::warpPerspective(image, turned, H, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  const Features a = extract_features(image, cv::Mat(), Sensor{ideal_camera()}, {});
  const Features b = extract_features(turned, cv::Mat(), Sensor{ideal_camera()}, {});
  EXPECT_GT(repeatability(a, b, H, 2), 0.6);
}

/// A smooth blob at a subpixel position is located there, on every level.
TEST(Extractor, LocatesCornersBetweenPixels) {
  double squared_error = 0;
  int found = 0;
  Random random(9);
  for (int trial = 0; trial < 20; ++trial) {
    const auto centre_y = static_cast<float>(random.uniform(200, 210));
    const cv::Point2f centre(static_cast<float>(random.uniform(200, 210)), centre_y);
    cv::Mat image(400, 400, CV_8UC1);
    for (int y = 0; y < image.rows; ++y) {
      for (int x = 0; x < image.cols; ++x) {
        const double r2 =
            std::pow(static_cast<float>(x) - centre.x, 2) + std::pow(static_cast<float>(y) - centre.y, 2);
        image.at<uint8_t>(y, x) = static_cast<uint8_t>(std::lround(30 + 200 * std::exp(-r2 / 8)));
      }
    }
    const Features f = extract_features(image, cv::Mat(), Sensor{ideal_camera()}, {});
    for (const auto& pixel : f.pixels) {
      const double error_px = (pixel - Eigen::Vector2f(centre.x, centre.y)).norm();
      squared_error += error_px * error_px;
      ++found;
    }
  }
  ASSERT_GT(found, 20);
  // Whole pixels alone would give an error of 0.41 px even on level 0.
  EXPECT_LT(std::sqrt(squared_error / found), 0.25);
}

TEST(Extractor, UndistortsKeypointsNotTheDepthMap) {
  PinholeCamera camera = ideal_camera();
  camera.lens.k1 = 0.262383;
  camera.lens.k2 = -0.953104;
  camera.lens.p1 = -0.005358;
  camera.lens.p2 = 0.002628;
  camera.lens.k3 = 1.163314;
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(2.0F));
  depth.colRange(0, 320).setTo(1.0F);
  const Features f = extract_features(cluttered_image(5), depth, Sensor{camera}, {});
  ASSERT_GT(f.size(), 500U);
  for (size_t i = 0; i < f.size(); ++i) {
    EXPECT_LT((camera.distort(f.pixels[i].cast<double>()) - f.raw_pixels[i].cast<double>()).norm(), 1e-2);
    const float x = f.raw_pixels[i].x();
    if (x < 317) {
      EXPECT_EQ(f.depths_m[i], 1.0F);
    }
    if (x > 323) {
      EXPECT_EQ(f.depths_m[i], 2.0F);
    }
  }
}

TEST(Extractor, EmptyAndTinyImagesHaveNoFeatures) {
  PinholeCamera camera = ideal_camera();
  EXPECT_EQ(
      extract_features(cv::Mat(480, 640, CV_8UC1, cv::Scalar(80)), cv::Mat(), Sensor{camera}, {}).size(), 0U);
  camera.width = camera.height = 20;
  EXPECT_EQ(extract_features(cv::Mat(20, 20, CV_8UC1, cv::Scalar(80)), cv::Mat(), Sensor{camera}, {}).size(),
            0U);
}

TEST(Extractor, RefusesColourAndDepthOfAnotherSize) {
  EXPECT_THROW(extract_features(cv::Mat(480, 640, CV_8UC3), cv::Mat(), Sensor{ideal_camera()}, {}),
               std::logic_error);
  EXPECT_THROW(extract_features(cluttered_image(6), cv::Mat(10, 10, CV_32FC1), Sensor{ideal_camera()}, {}),
               std::logic_error);
}

TEST(DepthAround, AveragesAndRefusesSteps) {
  cv::Mat depth(20, 20, CV_32FC1, cv::Scalar(1.0F));
  depth.at<float>(10, 10) = 1.009F;
  EXPECT_NEAR(average_depth(depth, {10, 10}, 0.04), 1.001F, 1e-5F);
  depth.at<float>(10, 10) = 0;  // a hole does not affect its neighbourhood
  EXPECT_NEAR(average_depth(depth, {10, 10}, 0.04), 1.0F, 1e-6F);
  depth.col(11).setTo(1.5F);
  EXPECT_EQ(average_depth(depth, {10, 10}, 0.04), 0.0F);
  EXPECT_EQ(average_depth(depth, {0, 5}, 0.04), 0.0F);
  depth.setTo(0.0F);
  EXPECT_EQ(average_depth(depth, {5, 5}, 0.04), 0.0F);
}

/// Every kind supported by the build.
std::vector<FeatureKind> float_kinds() {
  std::vector<FeatureKind> kinds = {FeatureKind::kSift};
  if (surf_available()) kinds.push_back(FeatureKind::kSurf);
  return kinds;
}

TEST(FloatFeatures, AreFoundAgainOnATurnedAndLargerImage) {
  const cv::Mat image = cluttered_image(4);
  const cv::Mat turn = cv::getRotationMatrix2D({320, 240}, 20, 1.3);
  cv::Mat turned;
  cv::warpAffine(image, turned, turn, image.size());
  for (const FeatureKind kind : float_kinds()) {
    FeatureOptions options;
    options.kind = kind;
    const Features a = extract_features(image, cv::Mat(), Sensor{ideal_camera()}, options);
    const Features b = extract_features(turned, cv::Mat(), Sensor{ideal_camera()}, options);
    ASSERT_EQ(a.descriptors.type(), CV_8UC1);
    ASSERT_EQ(a.descriptors.cols, 32);
    EXPECT_LT(*std::max_element(a.levels.begin(), a.levels.end()), a.level_count);
    int right = 0, level_shift = 0;
    const auto matches = filter_matches_by_distance(match_brute_force(a.descriptors, b.descriptors, true));
    for (const Match& match : matches) {
      const Eigen::Vector2f& p = a.pixels[match.a];
      const cv::Mat q = turn * (cv::Mat_<double>(3, 1) << p.x(), p.y(), 1);
      const Eigen::Vector2d expected(q.at<double>(0), q.at<double>(1));
      if ((b.pixels[match.b].cast<double>() - expected).norm() > 3) continue;
      ++right;
      level_shift += b.levels[match.b] - a.levels[match.a];
    }
    EXPECT_GT(right, 100) << name_of(kind);
    EXPECT_GT(right, static_cast<int>(matches.size()) * 8 / 10) << name_of(kind);
    EXPECT_NEAR(static_cast<double>(level_shift) / right, std::log(1.3) / std::log(1.2), 0.5)
        << name_of(kind);
  }
}

TEST(FloatFeatures, DifferentBitsTellTheAngleBetweenDescriptors) {
  constexpr int kPairs = 300, kDimensions = 128;
  Random random(7);
  cv::Mat rows(2 * kPairs, kDimensions, CV_32FC1);
  std::vector<double> angles;
  for (int i = 0; i < kPairs; ++i) {
    Eigen::VectorXd a(kDimensions), b(kDimensions);
    const double mix = random.uniform(0, 2);
    for (int d = 0; d < kDimensions; ++d) {
      a(d) = random.gaussian();
      b(d) = a(d) + mix * random.gaussian();
    }
    a.array() -= a.mean();
    b.array() -= b.mean();
    angles.push_back(std::acos(a.dot(b) / (a.norm() * b.norm())));
    for (int d = 0; d < kDimensions; ++d) {
      rows.at<float>(2 * i, d) = static_cast<float>(a(d)) + 40;  // a common offset does not matter
      rows.at<float>(2 * i + 1, d) = static_cast<float>(b(d)) + 25;
    }
  }
  const cv::Mat bits = binarize_descriptors(rows, 1);
  for (int i = 0; i < kPairs; ++i) {
    const double share = hamming_distance(bits.ptr<uint8_t>(2 * i), bits.ptr<uint8_t>(2 * i + 1)) / 256.0;
    EXPECT_NEAR(share, angles[static_cast<size_t>(i)] / std::numbers::pi,
                0.14);  // 4.5 sigma of 256 coin tosses
  }
}

TEST(FloatFeatures, AnImageWithoutCornersHasNone) {
  for (const FeatureKind kind : float_kinds()) {
    FeatureOptions options;
    options.kind = kind;
    const cv::Mat blank(240, 320, CV_8UC1, cv::Scalar(90));
    EXPECT_EQ(extract_features(blank, cv::Mat(), Sensor{ideal_camera()}, options).size(), 0U);
  }
}

/// A fisheye lens of 170 degrees.
PinholeCamera fisheye_camera() {
  const std::vector<double> coefficients{0.02, -0.015, 0.004, -0.0007};
  return {1280, 1280, 400, 405, 639.5, 640, lens_with(LensModel::kKannalaBrandt, coefficients)};
}

/// Inverse depth of a slanted plane at an undistorted pixel: linear in it.
double inverse_depth_of_plane(const PinholeCamera& c, const Eigen::Vector2d& pixel) {
  return 0.5 + 0.15 * (pixel.x() - c.cx) / c.fx + 0.05 * (pixel.y() - c.cy) / c.fy;
}

TEST(SampleKeypoint, PredictsASlantedPlaneInTheUndistortedImageOfAFisheye) {
  const PinholeCamera camera = fisheye_camera();
  cv::Mat depth_m(camera.height, camera.width, CV_32FC1, cv::Scalar(0));
  for (int y = 0; y < depth_m.rows; ++y) {
    for (int x = 0; x < depth_m.cols; ++x) {
      const Eigen::Vector2d pixel = camera.undistort({x, y});
      const double inverse_depth = inverse_depth_of_plane(camera, pixel);
      if (inverse_depth > 0.1) depth_m.at<float>(y, x) = static_cast<float>(1 / inverse_depth);
    }
  }
  constexpr float kRawSigma_px = 1.5F;
  int checked = 0;
  for (const double degrees : {0.0, 30.0, 55.0, 75.0}) {
    for (int k = -3; k <= 3; ++k) {  // where the plane is in front of the camera
      const double radius = std::tan(degrees * std::numbers::pi / 180);
      const Eigen::Vector2d seen(camera.cx + camera.fx * radius * std::cos(0.3 * k),
                                 camera.cy + camera.fy * radius * std::sin(0.3 * k));
      const Eigen::Vector2d raw = camera.distort(seen).array().round();
      const KeypointSample sample = sample_keypoint(depth_m, raw, kRawSigma_px, {camera}, {});
      const Eigen::Vector2d pixel = camera.undistort(raw);
      ASSERT_GT(sample.depth_m, 0);
      ASSERT_TRUE(sample.inverse_depth_gradient.allFinite());
      EXPECT_LT((sample.pixel.cast<double>() - pixel).norm(), 1e-3);
      for (const Eigen::Vector2d& step :
           {Eigen::Vector2d(6, 0), Eigen::Vector2d(0, 6), Eigen::Vector2d(-4, 4)}) {
        const Eigen::Vector2d neighbor = camera.undistort(raw + step);
        const double change =
            inverse_depth_of_plane(camera, neighbor) - inverse_depth_of_plane(camera, pixel);
        const double predicted = sample.inverse_depth_gradient.cast<double>().dot(neighbor - pixel);
        EXPECT_NEAR(predicted, change, 0.02 * std::abs(change) + 2e-5) << degrees << " " << step.transpose();
      }
      Eigen::Matrix2d interval;
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d half = 0.5 * Eigen::Vector2d::Unit(axis);
        interval.col(axis) = camera.undistort(raw + half) - camera.undistort(raw - half);
      }
      const double expected = static_cast<double>(kRawSigma_px) * std::sqrt(std::abs(interval.determinant()));
      EXPECT_NEAR(static_cast<double>(sample.sigma_px), expected, 0.01 * expected);
      ++checked;
    }
  }
  EXPECT_EQ(checked, 28);
}

TEST(SampleKeypoint, LeavesAnIdealLensAlone) {
  const cv::Mat depth_m(480, 640, CV_32FC1, cv::Scalar(2));
  const KeypointSample sample = sample_keypoint(depth_m, {100, 50}, 1.44F, {ideal_camera()}, {});
  EXPECT_EQ(sample.sigma_px, 1.44F);
  EXPECT_EQ(sample.depth_m, 2);
  EXPECT_EQ(sample.pixel, Eigen::Vector2f(100, 50));
}

}  // namespace
}  // namespace kinloop
