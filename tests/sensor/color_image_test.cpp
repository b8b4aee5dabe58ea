#include "kinloop/sensor/images/color_image.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "tests/drivers/sequence_folder.hpp"

namespace kinloop {
namespace {

using test::encoded;
using test::make_color;

double max_difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

cv::Mat converted(const cv::Mat& bgr) {
  cv::Mat gray;
  cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

TEST(ColorImage, PixelsAreGivenBackAndConverted) {
  const cv::Mat pixels = make_color(1);
  const ColorImage image = pixels;
  EXPECT_EQ(image.size(), pixels.size());
  EXPECT_TRUE(image.jpeg().empty());
  EXPECT_EQ(max_difference(image.bgr(), pixels), 0);
  EXPECT_EQ(max_difference(image.gray(), converted(pixels)), 0);
}

TEST(ColorImage, AJpegKeepsItsBytesAndGivesTheColourOfItsDecoder) {
  const std::string file = encoded(make_color(2), ".jpg");
  const auto image = ColorImage::from_jpeg(file);
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->size(), make_color(2).size());
  EXPECT_EQ(image->jpeg(), file);
  EXPECT_EQ(max_difference(image->bgr(), decode_jpeg(file)), 0);
}

TEST(ColorImage, TheGreyOfAJpegIsThatOfItsColourUpToRounding) {
  cv::Mat pixels(60, 80, CV_8UC3);  // away from black and white, where colours are clipped
  for (int y = 0; y < pixels.rows; ++y) {
    for (int x = 0; x < pixels.cols; ++x) {
      pixels.at<cv::Vec3b>(y, x) = {static_cast<uint8_t>(90 + x / 2), static_cast<uint8_t>(150 - y / 2),
                                    static_cast<uint8_t>(100 + (x + y) / 4)};
    }
  }
  const auto image = ColorImage::from_jpeg(encoded(pixels, ".jpg"));
  ASSERT_TRUE(image.has_value());
  const cv::Mat gray = image->gray();
  ASSERT_EQ(gray.type(), CV_8UC1);
  EXPECT_LE(max_difference(gray, converted(image->bgr())), 2);
}

TEST(ColorImage, AGreyJpegHasBothForms) {
  const auto image = ColorImage::from_jpeg(encoded(make_color(3, CV_8UC1), ".jpg"));
  ASSERT_TRUE(image.has_value());
  EXPECT_EQ(image->bgr().type(), CV_8UC3);
  EXPECT_EQ(max_difference(image->gray(), converted(image->bgr())), 0);
}

TEST(ColorImage, NoJpegNoImage) {
  EXPECT_FALSE(ColorImage::from_jpeg("").has_value());
  EXPECT_FALSE(ColorImage::from_jpeg("\xff\xd8\xff nothing").has_value());
  EXPECT_FALSE(ColorImage::from_jpeg(encoded(make_color(1), ".png")).has_value());
}

TEST(ColorImage, EmptyWithoutPixels) {
  EXPECT_TRUE(ColorImage().empty());
  EXPECT_TRUE(ColorImage(cv::Mat()).gray().empty());
  EXPECT_THROW(ColorImage(cv::Mat(4, 4, CV_8UC1)), std::logic_error);
}

}  // namespace
}  // namespace kinloop
