#include "drivers/ros/ros_image.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/ros/ros_topics.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

RosImage message_of(const cv::Mat& image, const std::string& encoding) {
  return {image.cols, image.rows, image.step,
          encoding,   false,      {image.data, image.step * static_cast<size_t>(image.rows)}};
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(RosImage, EveryColorEncodingBecomesBgr) {
  const cv::Mat bgr = test::make_color(1);
  const auto in = [&](int code) {
    cv::Mat image;
    cv::cvtColor(bgr, image, code);
    return image;
  };
  EXPECT_TRUE(equal(color_from(message_of(bgr, "bgr8")), bgr));
  EXPECT_TRUE(equal(color_from(message_of(in(cv::COLOR_BGR2RGB), "rgb8")), bgr));
  EXPECT_TRUE(equal(color_from(message_of(in(cv::COLOR_BGR2BGRA), "bgra8")), bgr));
  EXPECT_TRUE(equal(color_from(message_of(in(cv::COLOR_BGR2RGBA), "rgba8")), bgr));
  const cv::Mat gray = color_from(message_of(in(cv::COLOR_BGR2GRAY), "mono8"));
  EXPECT_EQ(gray.type(), CV_8UC3);
}

TEST(RosImage, RowsMayBePadded) {
  const cv::Mat wide = test::make_color(2, CV_8UC3, {40, 24}), part = wide.colRange(0, 32);
  EXPECT_TRUE(
      equal(color_from({32, 24, wide.step, "bgr8", false, {wide.data, wide.step * 24}}), part.clone()));
}

TEST(RosImage, DepthIsInMetresAndZeroWhereUnknown) {
  const cv::Mat millimetres = (cv::Mat_<uint16_t>(1, 2) << 1500, 0);
  const cv::Mat a = depth_from(message_of(millimetres, "16UC1"));
  EXPECT_FLOAT_EQ(a.at<float>(0), 1.5F);
  EXPECT_EQ(a.at<float>(1), 0);
  const cv::Mat metres = (cv::Mat_<float>(1, 2) << 2.25F, std::numeric_limits<float>::quiet_NaN());
  const cv::Mat b = depth_from(message_of(metres, "32FC1"));
  EXPECT_EQ(b.at<float>(0), 2.25F);
  EXPECT_EQ(b.at<float>(1), 0);
}

TEST(RosImage, CompressedImages) {
  const cv::Mat bgr = test::make_color(3), millimetres = test::make_depth(1234);
  std::vector<uint8_t> png;
  cv::imencode(".png", bgr, png);
  EXPECT_TRUE(equal(color_from_compressed(png).bgr(), bgr));
  std::vector<uint8_t> depth;
  cv::imencode(".png", millimetres, depth);
  EXPECT_FLOAT_EQ(depth_from_compressed("16UC1; png compressed", depth).at<float>(0), 1.234F);
  depth.insert(depth.begin(), 12, 0);
  EXPECT_FLOAT_EQ(depth_from_compressed("16UC1; compressedDepth", depth).at<float>(0), 1.234F);
}

TEST(RosImage, SaysWhatItCannotRead) {
  const cv::Mat bgr = test::make_color(4);
  EXPECT_THAT(input_error([&] { color_from(message_of(bgr, "yuv422")); }),
              AllOf(HasSubstr("yuv422"), HasSubstr("bgr8")));
  EXPECT_THAT(input_error([&] { depth_from(message_of(bgr, "8UC3")); }), HasSubstr("16UC1"));
  RosImage cut = message_of(bgr, "bgr8");
  cut.data = cut.data.subspan(1);
  EXPECT_THAT(input_error([&] { color_from(cut); }), HasSubstr("truncated"));
  RosImage other_end = message_of(test::make_depth(1), "16UC1");
  other_end.big_endian = true;
  EXPECT_THAT(input_error([&] { depth_from(other_end); }), HasSubstr("big-endian"));
  EXPECT_THAT(input_error([&] { color_from_compressed({}); }), HasSubstr("cannot be decoded"));
  EXPECT_THAT(input_error([&] { depth_from_compressed("32FC1; compressedDepth", std::vector<uint8_t>(5)); }),
              HasSubstr("truncated"));
}

TEST(RosCameraInfo, BecomesACamera) {
  RosCameraInfo info{640, 480, "plumb_bob", {0.1, -0.2, 0.001, 0.002, 0.3}, {}, {}};
  info.K = {520, 0, 320, 0, 521, 240, 0, 0, 1};
  info.P = {500, 0, 310, 0, 0, 501, 235, 0, 0, 0, 1, 0};
  const PinholeCamera raw = camera_from(info, false);
  EXPECT_EQ(raw.fx, 520);
  EXPECT_EQ(raw.p2, 0.002);
  const PinholeCamera rectified = camera_from(info, true);
  EXPECT_EQ(rectified.fx, 500);
  EXPECT_EQ(rectified.cy, 235);
  EXPECT_FALSE(rectified.has_distortion());
  info.distortion_model = "equidistant";
  EXPECT_THAT(input_error([&] { camera_from(info, false); }), HasSubstr("equidistant"));
  EXPECT_THAT(input_error([&] { camera_from({}, false); }), HasSubstr("uncalibrated"));
}

TEST(RosTopics, AreReadFromText) {
  const RosTopics topics = parse_topics("/cam/rgb/image,/cam/depth/image");
  EXPECT_EQ(topics.color, "/cam/rgb/image");
  EXPECT_EQ(topics.depth, "/cam/depth/image");
  EXPECT_EQ(topics.info, "/cam/rgb/camera_info");
  EXPECT_EQ(parse_topics("/a,/b,/c").info, "/c");
  for (const char* wrong : {"", "/a", "/a,", "a,b", "/a,/b,/c,/d"}) {
    EXPECT_THAT(test::usage_error([&] { parse_topics(wrong); }), HasSubstr("--topics"));
  }
}

}  // namespace
}  // namespace kinloop
