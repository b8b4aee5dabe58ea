#include "drivers/image_files/jpeg_header.hpp"

#include <string>

#include <gmock/gmock.h>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"

namespace kinloop {
namespace {

using namespace std::string_literals;
using testing::HasSubstr;

std::string jpeg() {
  const auto bytes = encode_jpeg(cv::Mat(8, 16, CV_8UC3, cv::Scalar(10, 200, 30)), 90);
  return {bytes.begin(), bytes.end()};
}

/// A JPEG with EXIF whose only entry is the orientation, in either byte order.
std::string jpeg_with_orientation(char orientation, bool little) {
  const std::string tiff =
      little ? "II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"s + orientation + "\0\0\0\0\0\0\0"s
             : "MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0"s + orientation + "\0\0\0\0\0\0"s;
  const std::string content = "Exif\0\0"s + tiff;
  std::string file = jpeg();
  return file.insert(2, "\xff\xe1\0"s + static_cast<char>(content.size() + 2) + content);
}

TEST(JpegHeader, TheOrientationIsThatOfExif) {
  EXPECT_EQ(exif_orientation(jpeg()), 1);
  for (const bool little : {false, true}) {
    for (const char orientation : {'\1', '\3', '\6', '\x8'})
      EXPECT_EQ(exif_orientation(jpeg_with_orientation(orientation, little)), orientation) << little;
    EXPECT_EQ(exif_orientation(jpeg_with_orientation('\x9', little)), 1);  // means nothing
  }
}

TEST(JpegHeader, ATruncatedHeaderIsUpright) {
  const std::string whole = jpeg_with_orientation('\6', true);
  for (size_t size = 0; size < whole.size(); ++size) {
    const std::string cut = whole.substr(0, size);
    EXPECT_TRUE(exif_orientation(cut) == 1 || exif_orientation(cut) == 6);
    static_cast<void>(jpeg_components(cut));
  }
}

TEST(JpegHeader, OnlyImagesThatViewersTurnAreSaidToBeTurned) {
  EXPECT_EQ(turned_by_exif(jpeg()), "");
  EXPECT_EQ(turned_by_exif(jpeg_with_orientation('\1', true)), "");
  EXPECT_THAT(turned_by_exif(jpeg_with_orientation('\6', false)), HasSubstr("orientation is 6"));
}

TEST(JpegHeader, CmykIsToldFromDamage) {
  std::string cmyk = jpeg();
  EXPECT_EQ(jpeg_components(cmyk), 3);
  cmyk[cmyk.find("\xff\xc0"s) + 9] = 4;
  EXPECT_EQ(jpeg_components(cmyk), 4);
  EXPECT_THAT(std::string(image_damage(cmyk)), HasSubstr("CMYK"));
}

}  // namespace
}  // namespace kinloop
