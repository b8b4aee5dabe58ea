#include "kinloop/features/extractor.hpp"

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "kinloop/base/random.hpp"
#include "kinloop/features/corner_detector.hpp"

namespace kinloop {
namespace {

PinholeCamera ideal_camera() {
  PinholeCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 525;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

/// Random rectangles of all sizes; the right half is dim, as rooms have dim corners.
cv::Mat cluttered_image(uint64_t seed) {
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(100));
  Random random(seed);
  for (int i = 0; i < 900; ++i) {
    const cv::Point corner(static_cast<int>(random.index(640)), static_cast<int>(random.index(480)));
    const cv::Size size(4 + static_cast<int>(random.index(40)), 4 + static_cast<int>(random.index(40)));
    cv::rectangle(image, cv::Rect(corner, size), cv::Scalar(random.uniform(0, 255)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, {}, 0.8);
  cv::Mat right = image.colRange(320, 640);
  right.convertTo(right, CV_8U, 0.25, 20);
  return image;
}

TEST(Extractor, GivesOneEntryPerKeyPoint) {
  const Features f = extract_features(cluttered_image(1), cv::Mat(), ideal_camera(), {});
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

TEST(Extractor, SpreadsOverDimAndBrightParts) {
  const Features f = extract_features(cluttered_image(2), cv::Mat(), ideal_camera(), {});
  const auto right =
      std::count_if(f.pixels.begin(), f.pixels.end(), [](const auto& p) { return p.x() > 320; });
  EXPECT_GT(right, static_cast<long>(f.size() * 35 / 100));
  EXPECT_LT(right, static_cast<long>(f.size() * 65 / 100));
}

TEST(Extractor, DescribesAsOpenCvDoes) {
  const cv::Mat image = cluttered_image(3);
  const FeatureOptions options;
  auto corners = detect_corners(build_pyramid(image, options), options);
  cv::Mat expected;
  cv::ORB::create(options.count, 1.2F, 8)->compute(image, corners, expected);
  const Features f = extract_features(image, cv::Mat(), ideal_camera(), options);
  ASSERT_EQ(f.descriptors.rows, expected.rows);
  EXPECT_EQ(cv::norm(f.descriptors, expected, cv::NORM_HAMMING), 0);
}

TEST(Extractor, FindsTheSameCornersInAShiftedImage) {
  const cv::Mat image = cluttered_image(4);
  cv::Mat shifted;
  const cv::Matx23d shift(1, 0, 7, 0, 1, 5);
  cv::warpAffine(image, shifted, shift, image.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
  const Features a = extract_features(image, cv::Mat(), ideal_camera(), {});
  const Features b = extract_features(shifted, cv::Mat(), ideal_camera(), {});
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

TEST(Extractor, UndistortsKeyPointsNotTheDepthMap) {
  PinholeCamera camera = ideal_camera();
  camera.k1 = 0.262383;
  camera.k2 = -0.953104;
  camera.p1 = -0.005358;
  camera.p2 = 0.002628;
  camera.k3 = 1.163314;
  cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(2.0F));
  depth.colRange(0, 320).setTo(1.0F);
  const Features f = extract_features(cluttered_image(5), depth, camera, {});
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
  EXPECT_EQ(extract_features(cv::Mat(480, 640, CV_8UC1, cv::Scalar(80)), cv::Mat(), camera, {}).size(), 0U);
  camera.width = camera.height = 20;
  EXPECT_EQ(extract_features(cv::Mat(20, 20, CV_8UC1, cv::Scalar(80)), cv::Mat(), camera, {}).size(), 0U);
}

TEST(Extractor, RefusesColourAndDepthOfAnotherSize) {
  EXPECT_THROW(extract_features(cv::Mat(480, 640, CV_8UC3), cv::Mat(), ideal_camera(), {}), std::logic_error);
  EXPECT_THROW(extract_features(cluttered_image(6), cv::Mat(10, 10, CV_32FC1), ideal_camera(), {}),
               std::logic_error);
}

TEST(DepthAround, AveragesAndRefusesSteps) {
  cv::Mat depth(20, 20, CV_32FC1, cv::Scalar(1.0F));
  depth.at<float>(10, 10) = 1.009F;
  EXPECT_NEAR(depth_around(depth, {10, 10}, 0.04), 1.001F, 1e-5F);
  depth.at<float>(10, 10) = 0;  // a hole does not spoil its surroundings
  EXPECT_NEAR(depth_around(depth, {10, 10}, 0.04), 1.0F, 1e-6F);
  depth.col(11).setTo(1.5F);
  EXPECT_EQ(depth_around(depth, {10, 10}, 0.04), 0.0F);
  EXPECT_EQ(depth_around(depth, {0, 5}, 0.04), 0.0F);
  depth.setTo(0.0F);
  EXPECT_EQ(depth_around(depth, {5, 5}, 0.04), 0.0F);
}

}  // namespace
}  // namespace kinloop
