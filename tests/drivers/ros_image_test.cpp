#include "drivers/ros/messages/ros_image.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/ros/messages/ros_topics.hpp"
#include "kinloop/core/files/byte_reader.hpp"
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

TEST(RosImage, RowsAreWholeValues) {
  const std::vector<uint8_t> bytes(2 * 7);
  EXPECT_THAT(input_error([&] {
                depth_from({3, 2, 7, "16UC1", false, bytes});
              }),
              HasSubstr("rows of 7 bytes, not whole values of 2 bytes"));
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
  EXPECT_THAT(input_error([&] { color_from(message_of(bgr, "bayer_rggb8")); }),
              AllOf(HasSubstr("bayer_rggb8"), HasSubstr("bgr8")));
  EXPECT_THAT(input_error([&] { depth_from(message_of(bgr, "8UC3")); }), HasSubstr("16UC1"));
  RosImage cut = message_of(bgr, "bgr8");
  cut.data = cut.data.subspan(1);
  EXPECT_THAT(input_error([&] { color_from(cut); }), HasSubstr("truncated"));
  EXPECT_THAT(input_error([&] { color_from_compressed({}); }), HasSubstr("cannot be decoded"));
  EXPECT_THAT(input_error([&] { depth_from_compressed("32FC1; compressedDepth", std::vector<uint8_t>(5)); }),
              HasSubstr("truncated"));
}

TEST(RosImage, DepthMayBeBigEndian) {
  const cv::Mat swapped = (cv::Mat_<uint16_t>(1, 2) << 0xDC05, 0);  // 1500 = 0x05DC
  RosImage image = message_of(swapped, "16UC1");
  image.big_endian = true;
  EXPECT_FLOAT_EQ(depth_from(image).at<float>(0), 1.5F);
  cv::Mat metres = (cv::Mat_<float>(1, 1) << byte_swapped(2.5F));
  RosImage floats = message_of(metres, "32FC1");
  floats.big_endian = true;
  EXPECT_EQ(depth_from(floats).at<float>(0), 2.5F);
}

TEST(RosImage, QuantisedInverseDepthIsUndone) {
  const float a = 1000, b = -10;
  std::string header(4, '\0');
  header.append(reinterpret_cast<const char*>(&a), 4).append(reinterpret_cast<const char*>(&b), 4);
  const cv::Mat values = (cv::Mat_<uint16_t>(1, 3) << 0, 490, 90);
  const cv::Mat depth_m =
      depth_from_compressed("32FC1; compressedDepth png", as_bytes(header + test::encoded(values, ".png")));
  EXPECT_EQ(depth_m.at<float>(0), 0);
  EXPECT_FLOAT_EQ(depth_m.at<float>(1), 2);
  EXPECT_FLOAT_EQ(depth_m.at<float>(2), 10);
}

/// RVL as its inventor defined it: runs of zeros and of differences, in nibbles.
std::string rvl_of(const std::vector<int>& values) {
  std::vector<uint32_t> nibbles;
  const auto number = [&](uint32_t n) {
    do {
      nibbles.push_back((n & 7U) | (n > 7 ? 8U : 0U));
      n >>= 3U;
    } while (n != 0);
  };
  int previous = 0;
  for (size_t i = 0; i < values.size();) {
    size_t zeros = 0, others = 0;
    while (i + zeros < values.size() && values[i + zeros] == 0) ++zeros;
    number(static_cast<uint32_t>(zeros));
    i += zeros;
    while (i + others < values.size() && values[i + others] != 0) ++others;
    number(static_cast<uint32_t>(others));
    for (; others > 0; --others, ++i) {
      const int delta = values[i] - previous;
      number(static_cast<uint32_t>((delta << 1) ^ (delta >> 31)));
      previous = values[i];
    }
  }
  while (nibbles.size() % 8 != 0) nibbles.push_back(0);
  std::string bytes;
  for (size_t i = 0; i < nibbles.size(); i += 8) {
    uint32_t word = 0;
    for (size_t k = 0; k < 8; ++k) word = word << 4U | nibbles[i + k];
    bytes.append(reinterpret_cast<const char*>(&word), 4);
  }
  return bytes;
}

TEST(RosImage, RvlDepthIsDecoded) {
  const std::vector<int> values = {0, 0, 1500, 1502, 1499, 0, 9000, 1, 65535, 0, 0, 3};
  std::string data(12, '\0');
  const uint32_t width = 4, height = 3;
  data.append(reinterpret_cast<const char*>(&width), 4).append(reinterpret_cast<const char*>(&height), 4);
  const std::string rvl = rvl_of(values);
  const cv::Mat depth_m = depth_from_compressed("16UC1; compressedDepth rvl", as_bytes(data + rvl));
  ASSERT_EQ(depth_m.size(), cv::Size(4, 3));
  for (size_t i = 0; i < values.size(); ++i)
    EXPECT_FLOAT_EQ(depth_m.ptr<float>()[i], static_cast<float>(values[i]) * 0.001F);
  for (size_t cut = 0; cut < rvl.size(); ++cut) {
    EXPECT_THAT(input_error([&] {
                  depth_from_compressed("16UC1; compressedDepth rvl", as_bytes(data + rvl.substr(0, cut)));
                }),
                HasSubstr("RVL"));
  }
}

TEST(RosImage, AnImageThatClaimsTooManyPixelsIsNotDecoded) {
  std::string png = test::encoded(test::make_depth(1), ".png");
  png[16] = png[20] = 0x7F;  // highest bytes of width and height
  EXPECT_THAT(input_error([&] { depth_from_compressed("16UC1", as_bytes(png)); }), HasSubstr("claims"));
  std::string jpeg = test::encoded(test::make_color(1), ".jpg");
  EXPECT_EQ(color_from_compressed(as_bytes(jpeg)).size().width, test::kWidth);
  EXPECT_THAT(input_error([&] { color_from_compressed(as_bytes(jpeg.substr(0, jpeg.size() - 9))); }),
              HasSubstr("truncated"));
  const size_t frame_header = jpeg.find("\xff\xc0");
  jpeg.replace(frame_header + 5, 4, "\xff\xff\xff\xff");
  EXPECT_THAT(input_error([&] { color_from_compressed(as_bytes(jpeg)); }), HasSubstr("claims"));
}

TEST(RosCameraInfo, BecomesACamera) {
  RosCameraInfo info{640, 480, "plumb_bob", {0.1, -0.2, 0.001, 0.002, 0.3}, {}, {}};
  info.K = {520, 0, 320, 0, 521, 240, 0, 0, 1};
  info.P = {500, 0, 310, 0, 0, 501, 235, 0, 0, 0, 1, 0};
  const PinholeCamera raw = camera_from(info, false);
  EXPECT_EQ(raw.fx, 520);
  EXPECT_EQ(raw.lens.p2, 0.002);
  const PinholeCamera rectified = camera_from(info, true);
  EXPECT_EQ(rectified.fx, 500);
  EXPECT_EQ(rectified.cy, 235);
  EXPECT_FALSE(rectified.has_distortion());
  info.distortion_model = "omnidirectional";
  EXPECT_THAT(input_error([&] { camera_from(info, false); }),
              AllOf(HasSubstr("omnidirectional"), HasSubstr("--camera")));
  EXPECT_THAT(input_error([&] { camera_from({}, false); }), HasSubstr("uncalibrated"));
}

TEST(RosCameraInfo, HasTheLensOfItsModel) {
  RosCameraInfo info{640, 480, "rational_polynomial", {1, 2, 3, 4, 5, 6, 7, 8}, {}, {}};
  info.K = {520, 0, 320, 0, 521, 240, 0, 0, 1};
  const LensDistortion rational{LensModel::kRational, 1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(camera_from(info, false).lens, rational);
  info.D.resize(14, 0);  // thin prism and tilt, unused
  EXPECT_EQ(camera_from(info, false).lens, rational);
  info.D.back() = 0.1;
  EXPECT_THAT(input_error([&] { camera_from(info, false); }), HasSubstr("14 coefficients"));
  info.distortion_model = "equidistant";
  info.D = {0, 0, 0, 0};
  EXPECT_EQ(camera_from(info, false).lens.model, LensModel::kKannalaBrandt);
  info.D = {0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(lens_coefficients(camera_from(info, false).lens), info.D);
  EXPECT_FALSE(camera_from(info, true).has_distortion());
}

/// The SDK projects by its modified Brown-Conrady model where it says inverse, too.
TEST(RealsenseLens, IsApproximatedWithinATenthOfAPixel) {
  RosCameraInfo info;
  info.width = 1280, info.height = 720, info.K = {640, 0, 640, 0, 640, 360, 0, 0, 1};
  info.D = {-0.056, 0.068, 0.0003, 0.0005, -0.022};  // of a D455
  for (const char* model : {"Inverse Brown Conrady", "Modified Brown Conrady"}) {
    info.distortion_model = model;
    const PinholeCamera camera = camera_from(info, false);
    for (const Eigen::Vector2d& ideal : {Eigen::Vector2d(0, 0), {1279, 0}, {640, 700}, {100, 400}}) {
      const double x = (ideal.x() - 640) / 640, y = (ideal.y() - 360) / 640, r2 = x * x + y * y;
      const double radial = 1 + r2 * (info.D[0] + r2 * (info.D[1] + r2 * info.D[4]));
      const double u = x * radial, v = y * radial;
      const Eigen::Vector2d distorted(u + 2 * info.D[2] * u * v + info.D[3] * (r2 + 2 * u * u),
                                      v + 2 * info.D[3] * u * v + info.D[2] * (r2 + 2 * v * v));
      const Eigen::Vector2d pixel = 640 * distorted + Eigen::Vector2d(640, 360);
      EXPECT_LT((camera.distort(ideal) - pixel).norm(), 0.1);
    }
  }
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
