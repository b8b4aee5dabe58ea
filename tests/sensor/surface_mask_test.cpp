#include "kinloop/sensor/surfaces/surface_mask.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/sensor/vga_surfaces.hpp"

namespace kinloop {
namespace {

class SurfaceMask : public testing::Test {
 protected:
  std::shared_ptr<const SurfaceCamera> camera_ = test::vga_surface_camera();
  cv::Mat marked_ = cv::Mat::zeros(camera_->grid.height, camera_->grid.width, CV_8UC1);
};

TEST_F(SurfaceMask, MarkedPointsAreUnknownAndTheOthersStay) {
  const SurfaceGrid wall = make_surface_grid(camera_, cv::Mat(480, 640, CV_32FC1, cv::Scalar(2.0F)));
  marked_.at<uint8_t>(10, 20) = 255;
  const SurfaceGrid rest = without_points(wall, marked_);
  for (size_t i = 0; i < marked_.total(); ++i) {
    const bool marked = marked_.data[i] != 0;
    EXPECT_EQ(rest.inverse_depths_per_m[i], marked ? 0 : wall.inverse_depths_per_m[i]);
    EXPECT_EQ(rest.gradients[i].allFinite(), !marked && wall.gradients[i].allFinite());
  }
}

TEST_F(SurfaceMask, APixelBelongsToTheNearestPoint) {
  marked_.at<uint8_t>(10, 20) = 255;
  for (const Eigen::Vector2f& inside : {Eigen::Vector2f(200, 100), {209, 109}, {204.5, 104.5}})
    EXPECT_TRUE(is_marked(marked_, *camera_, inside)) << inside.transpose();
  for (const Eigen::Vector2f& outside : {Eigen::Vector2f(199, 105), {210, 105}, {205, 99}, {-50, 1e9}})
    EXPECT_FALSE(is_marked(marked_, *camera_, outside)) << outside.transpose();
  EXPECT_FALSE(is_marked({}, *camera_, {205, 105}));
}

TEST_F(SurfaceMask, PixelsNearAMarkedPointAreMasked) {
  marked_.at<uint8_t>(0, 0) = marked_.at<uint8_t>(10, 20) = 255;
  const cv::Mat unmarked = unmarked_pixels(*camera_, marked_, {640, 480});
  EXPECT_EQ(unmarked.at<uint8_t>(105, 205), 0);
  EXPECT_EQ(unmarked.at<uint8_t>(105, 193), 0);  // around it
  EXPECT_EQ(unmarked.at<uint8_t>(105, 180), 255);
  EXPECT_EQ(unmarked.at<uint8_t>(0, 0), 0);
  EXPECT_EQ(cv::countNonZero(unmarked), 640 * 480 - 31 * 31 - 21 * 21);
}

TEST_F(SurfaceMask, OnlyLargeRegionsRemain) {
  marked_(cv::Rect(5, 5, 8, 8)) = 255;
  marked_(cv::Rect(30, 5, 4, 4)) = 255;   // too small
  marked_(cv::Rect(5, 30, 40, 2)) = 255;  // too narrow: an edge
  cv::Mat expected = cv::Mat::zeros(marked_.size(), CV_8UC1);
  expected(cv::Rect(5, 5, 8, 8)) = 255;
  EXPECT_EQ(cv::countNonZero(large_regions(marked_, 60) != expected), 0);
  EXPECT_EQ(cv::countNonZero(large_regions(marked_, 65)), 0);
}

TEST_F(SurfaceMask, MarksOfAnotherGridAreRefused) {
  const SurfaceGrid wall = make_surface_grid(camera_, cv::Mat(480, 640, CV_32FC1, cv::Scalar(2.0F)));
  EXPECT_THROW(without_points(wall, cv::Mat::zeros(3, 3, CV_8UC1)), std::logic_error);
  EXPECT_THROW(unmarked_pixels(*camera_, cv::Mat(), {640, 480}), std::logic_error);
}

}  // namespace
}  // namespace kinloop
