#include "kinloop/sensor/images/jpeg_codec.hpp"

#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/drivers/sequence_folder.hpp"

namespace kinloop {
namespace {

using test::encoded;
using test::make_color;

double largest_difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

std::string_view view_of(const std::vector<uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(DecodeJpeg, ColourIsBitForBitWhatOpenCVReads) {
  for (const int type : {CV_8UC3, CV_8UC1}) {
    const std::string bytes = encoded(make_color(4, type), ".jpg");
    const cv::Mat color = decode_jpeg(bytes);
    ASSERT_EQ(color.type(), CV_8UC3);
    EXPECT_EQ(largest_difference(
                  color, cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR)),
              0);
  }
}

TEST(DecodeJpeg, GreyIsThatOfAGreyFile) {
  const std::string bytes = encoded(make_color(4, CV_8UC1), ".jpg");
  EXPECT_EQ(
      largest_difference(decode_jpeg_gray(bytes),
                         cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_UNCHANGED)),
      0);
}

TEST(DecodeJpeg, OtherFilesAndDamagedHeadersGiveNothing) {
  const std::string whole = encoded(make_color(1), ".jpg");
  for (auto* decode : {decode_jpeg, decode_jpeg_gray}) {
    EXPECT_TRUE(decode("").empty());
    EXPECT_TRUE(decode(encoded(make_color(1), ".png")).empty());
    EXPECT_TRUE(decode(whole.substr(0, 100)).empty());
  }
}

TEST(DecodeJpeg, DamagedDataThatStillDecodeGiveNothing) {
  const std::string whole = encoded(make_color(1), ".jpg");
  std::string emptied = whole;  // the second half of the data are zeros
  std::fill(emptied.begin() + static_cast<long>(whole.size() / 2), emptied.end() - 2, '\0');
  const std::string padded =
      whole.substr(0, whole.size() - 2) + std::string(100, '\x55') + whole.substr(whole.size() - 2);
  for (auto* decode : {decode_jpeg, decode_jpeg_gray}) {
    EXPECT_TRUE(decode(whole.substr(0, whole.size() / 2) + "\xff\xd9").empty()) << "data end early";
    EXPECT_TRUE(decode(emptied).empty());
    EXPECT_TRUE(decode(padded).empty()) << "more data than the image takes";
  }
}

TEST(DecodeJpeg, AFewPaddingBytesAreNoDamage) {
  const std::string whole = encoded(make_color(1), ".jpg");
  const std::string padded =
      whole.substr(0, whole.size() - 2) + std::string(2, '\0') + whole.substr(whole.size() - 2);
  EXPECT_EQ(largest_difference(decode_jpeg(padded), decode_jpeg(whole)), 0);
}

/// A sampling of the single-byte damages: whatever is returned has the size that the header gives.
TEST(DecodeJpeg, DamagedFilesDoNoHarm) {
  const std::string whole = encoded(make_color(5), ".jpg");
  for (size_t at = 0; at < whole.size(); at += 7) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    const cv::Mat color = decode_jpeg(damaged), gray = decode_jpeg_gray(damaged);
    if (color.empty() || gray.empty()) continue;
    EXPECT_EQ(color.size(), gray.size()) << at;
  }
}

TEST(EncodeJpeg, IsWhatOpenCVWrites) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    for (const int quality : {50, 90, 95, 100}) {
      const cv::Mat image = make_color(6, type);
      std::vector<uint8_t> theirs;
      cv::imencode(".jpg", image, theirs, {cv::IMWRITE_JPEG_QUALITY, quality});
      EXPECT_EQ(
          largest_difference(decode_jpeg(view_of(encode_jpeg(image, quality))), decode_jpeg(view_of(theirs))),
          0)
          << quality;
    }
  }
}

TEST(EncodeJpeg, TakesPartsOfImagesAndRejectsOtherTypes) {
  const cv::Mat image = make_color(7);
  const cv::Mat part = image(cv::Rect(3, 2, 21, 13));
  EXPECT_EQ(encode_jpeg(part, 90), encode_jpeg(part.clone(), 90));
  EXPECT_THROW((void)encode_jpeg(cv::Mat(4, 4, CV_16UC1), 90), std::logic_error);
  EXPECT_THROW((void)encode_jpeg(cv::Mat(), 90), std::logic_error);
}

}  // namespace
}  // namespace kinloop
