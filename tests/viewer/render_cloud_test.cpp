#include "viewer/report/render_cloud.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace kinloop {
namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

/// A red floor of 4 m x 2 m at z = 0 and a green ceiling at z = 2.5 m.
ColoredCloud room() {
  ColoredCloud cloud;
  for (int x = 0; x < 200; ++x) {
    for (int y = 0; y < 100; ++y) {
      cloud.points.emplace_back(0.02F * static_cast<float>(x), 0.02F * static_cast<float>(y), 0.0F);
      cloud.colors.push_back({200, 0, 0});
      cloud.points.emplace_back(0.02F * static_cast<float>(x), 0.02F * static_cast<float>(y), 2.5F);
      cloud.colors.push_back({0, 200, 0});
    }
  }
  return cloud;
}

CloudPictureOptions from_above(double cut_above_m) {
  return {.up = {0, 0, 1}, .elevation_deg = 90, .cut_above_m = cut_above_m, .point_m = 0.02, .width_px = 300};
}

TEST(RenderCloud, FromAboveTheCeilingHidesTheFloorUnlessItIsCutOff) {
  const cv::Mat with = render_cloud(room(), from_above(kEverywhere));
  const cv::Mat without = render_cloud(room(), from_above(2));
  ASSERT_EQ(with.type(), CV_8UC4);
  EXPECT_EQ(with.at<cv::Vec4b>(with.rows / 2, 150), cv::Vec4b(0, 200, 0, 255));
  EXPECT_EQ(without.at<cv::Vec4b>(without.rows / 2, 150), cv::Vec4b(0, 0, 200, 255));
}

TEST(RenderCloud, HasTheLongSideAcrossAndTrueProportions) {
  auto cloud = room();
  for (auto& p : cloud.points) std::swap(p.x(), p.y());
  const cv::Mat picture = render_cloud(cloud, from_above(2));
  EXPECT_EQ(picture.cols, 300);
  EXPECT_NEAR(picture.rows, 150, 12);
}

TEST(RenderCloud, IsTransparentWhereNothingIs) {
  ColoredCloud cloud;
  for (const float x : {0.0F, 1.0F}) {
    for (int i = 0; i < 1000; ++i) {
      cloud.points.emplace_back(x, 0.0005F * static_cast<float>(i), 0.0F);
      cloud.colors.push_back({255, 255, 255});
    }
  }
  const cv::Mat picture = render_cloud(cloud, from_above(kEverywhere));
  EXPECT_EQ(picture.at<cv::Vec4b>(picture.rows / 2, 150)[3], 0);
}

TEST(RenderCloud, OfNothingIsEmpty) {
  EXPECT_TRUE(render_cloud({}, {}).empty());
  EXPECT_TRUE(render_cloud(room(), from_above(-1)).empty());
}

TEST(RenderCloud, PointsThatAreNowhereChangeNothing) {
  ColoredCloud cloud = room();
  const cv::Mat expected = render_cloud(cloud, from_above(kEverywhere));
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kLargest = 3e38F;
  for (const float x :
       {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity, kLargest, -kLargest}) {
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3f p(1, 1, 1);
      p[axis] = x;
      cloud.points.insert(cloud.points.begin(), 1000, p);
      cloud.colors.insert(cloud.colors.begin(), 1000, {1, 2, 3});
    }
  }
  const cv::Mat drawn = render_cloud(cloud, from_above(kEverywhere));
  ASSERT_EQ(drawn.size(), expected.size());
  EXPECT_EQ(cv::norm(drawn, expected, cv::NORM_INF), 0);
  cloud.points.resize(1000);  // none of the room
  cloud.colors.resize(1000);
  EXPECT_TRUE(render_cloud(cloud, from_above(kEverywhere)).empty());
}

TEST(RenderCloud, OfOnePointIsThatPoint) {
  ColoredCloud cloud;
  cloud.points.emplace_back(5, 6, 7);
  cloud.colors.push_back({1, 2, 3});
  const cv::Mat picture = render_cloud(cloud, from_above(kEverywhere));
  EXPECT_FALSE(picture.empty());
  EXPECT_GT(cv::countNonZero(picture.reshape(1)), 0);
}

}  // namespace
}  // namespace kinloop
