#include "drivers/image_files/image_file.hpp"

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/image_files/webp.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::encoded;
using test::input_error;
using test::make_color;
using test::make_depth;
using test::TempFolder;
using testing::HasSubstr;

double difference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

TEST(ReadColorImage, PngIsReadExactly) {
  const TempFolder folder;
  const cv::Mat image = make_color(1);
  const cv::Mat read = read_color_image(folder.write("a.png", encoded(image, ".png"))).bgr();
  ASSERT_EQ(read.type(), CV_8UC3);
  EXPECT_EQ(difference(read, image), 0);
}

TEST(ReadColorImage, JpegIsReadClosely) {
  const TempFolder folder;
  cv::Mat smooth;
  cv::GaussianBlur(make_color(1), smooth, {}, 4);
  const cv::Mat read = read_color_image(folder.write("a.jpg", encoded(smooth, ".jpg"))).bgr();
  ASSERT_EQ(read.type(), CV_8UC3);
  EXPECT_LT(difference(read, smooth), 20);
}

/// Formats of colour beside PNG and JPEG.
class OtherFormats : public testing::TestWithParam<const char*> {
 protected:
  /// Of colour, but for PGM, which has none.
  [[nodiscard]] static cv::Mat image(int seed, cv::Size size = {test::kWidth, test::kHeight}) {
    return make_color(seed, std::string(GetParam()) == ".pgm" ? CV_8UC1 : CV_8UC3, size);
  }
};

TEST_P(OtherFormats, AreReadExactly) {
  const TempFolder folder;
  for (const cv::Mat& written : {image(1), image(2, {31, 7})}) {  // the latter has rows that BMP pads
    const std::string bytes = encoded(written, GetParam());
    cv::Mat expected = written;
    if (written.channels() == 1) cv::cvtColor(written, expected, cv::COLOR_GRAY2BGR);
    EXPECT_EQ(encoded_size(bytes), written.size());
    EXPECT_EQ(difference(read_color_image(folder.write("a", bytes)).bgr(), expected), 0);
  }
}

TEST(ReadColorImage, GreyOfOtherFormatsBecomesThreeEqualChannels) {
  const TempFolder folder;
  const cv::Mat grey = make_color(3, CV_8UC1);
  cv::Mat expected;
  cv::cvtColor(grey, expected, cv::COLOR_GRAY2BGR);
  for (const char* format : {".pgm", ".bmp", ".tiff"})
    EXPECT_EQ(difference(read_color_image(folder.write("a", encoded(grey, format))).bgr(), expected), 0)
        << format;
}

TEST_P(OtherFormats, CutShortOrChangedAreReadOrRefused) {
  const TempFolder folder;
  const std::string whole = encoded(image(5), GetParam());
  int refused = 0;
  const auto try_bytes = [&](const std::string& bytes) {
    try {
      static_cast<void>(decode_color_image(bytes, "a"));
    } catch (const InputError&) {
      ++refused;
    }
  };
  for (size_t size = 0; size < whole.size(); size += 7) try_bytes(whole.substr(0, size));
  EXPECT_GT(refused, 50);
  Random random(8);
  for (int i = 0; i < test::mutations(300); ++i) try_bytes(test::mutated(whole, random));
}

INSTANTIATE_TEST_SUITE_P(Formats, OtherFormats, testing::Values(".ppm", ".pgm", ".bmp", ".tiff"),
                         [](const auto& format) { return std::string(format.param + 1); });

TEST(ReadColorImage, DeepPpmAndGreyOfSixteenBits) {
  const TempFolder folder;
  cv::Mat deep;
  make_color(1).convertTo(deep, CV_16U, 257);
  EXPECT_EQ(difference(read_color_image(folder.write("a.ppm", encoded(deep, ".ppm"))).bgr(), make_color(1)),
            0);
  const auto grey = folder.write("a.pgm", encoded(make_depth(1500), ".pgm"));
  EXPECT_THAT(input_error([&] { read_color_image(grey); }), HasSubstr("grey of 16 bits"));
}

TEST(ReadColorImage, ContentCountsNotTheNameOfTheFile) {
  const TempFolder folder;
  EXPECT_EQ(read_color_image(folder.write("a.png", encoded(make_color(1), ".jpg"))).size().width,
            test::kWidth);
}

TEST(ReadColorImage, GreyBecomesThreeEqualChannels) {
  const TempFolder folder;
  const cv::Mat grey = make_color(3, CV_8UC1);
  const cv::Mat read = read_color_image(folder.write("a.png", encoded(grey, ".png"))).bgr();
  ASSERT_EQ(read.type(), CV_8UC3);
  cv::Mat channels[3];
  cv::split(read, channels);
  for (const auto& channel : channels) EXPECT_EQ(difference(channel, grey), 0);
}

TEST(ReadColorImage, TransparencyIsLeftOut) {
  const TempFolder folder;
  const ColorImage read = read_color_image(folder.write("a.png", encoded(make_color(3, CV_8UC4), ".png")));
  EXPECT_EQ(read.bgr().type(), CV_8UC3);
}

TEST(ReadColorImage, ColourOfSixteenBitsIsScaledToEight) {
  const TempFolder folder;
  const cv::Mat image = make_color(1);
  for (const int type : {CV_16UC3, CV_16UC4}) {
    cv::Mat deep;
    make_color(1, CV_MAKETYPE(CV_8U, CV_MAT_CN(type))).convertTo(deep, type, 257);
    const std::string bytes = encoded(deep, ".png");
    EXPECT_TRUE(is_color_of_16_bits(bytes));
    EXPECT_EQ(read_color_image(folder.write("a.png", bytes)).bgr().type(), CV_8UC3);
    if (type == CV_16UC3) {
      EXPECT_EQ(difference(read_color_image(folder.path() / "a.png").bgr(), image), 0);
    }
  }
  EXPECT_FALSE(is_color_of_16_bits(encoded(image, ".png")));
  EXPECT_FALSE(is_color_of_16_bits(encoded(make_depth(7), ".png")));
}

TEST(ReadColorImage, SixteenBitGreySuggestsSwappedColumns) {
  const TempFolder folder;
  const auto path = folder.write("a.png", encoded(make_depth(7), ".png"));
  EXPECT_THAT(input_error([&] { read_color_image(path); }), HasSubstr("colour comes first"));
}

TEST(DepthImage, IsInMetresWithZeroForUnknown) {
  const TempFolder folder;
  cv::Mat raw = make_depth(2500);
  raw.at<uint16_t>(0, 0) = 0;
  raw.at<uint16_t>(0, 1) = 65535;
  raw.at<uint16_t>(0, 2) = 65534;
  raw.at<uint16_t>(0, 3) = 1;
  const cv::Mat depth_m = read_depth_image(folder.write("a.png", encoded(raw, ".png")), 5000);
  ASSERT_EQ(depth_m.type(), CV_32FC1);
  EXPECT_EQ(depth_m.at<float>(0, 0), 0.0F);
  EXPECT_EQ(depth_m.at<float>(0, 1), 0.0F);
  EXPECT_FLOAT_EQ(depth_m.at<float>(0, 2), 13.1068F);
  EXPECT_FLOAT_EQ(depth_m.at<float>(0, 3), 0.0002F);
  EXPECT_FLOAT_EQ(depth_m.at<float>(5, 5), 0.5F);
}

TEST(DepthImage, EightBitsAndColourAreRejected) {
  const TempFolder folder;
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC3}) {
    const auto path = folder.write("a.png", encoded(make_color(1, type), ".png"));
    EXPECT_THAT(input_error([&] { read_depth_image(path, 5000); }), HasSubstr("16-bit"));
  }
}

/// Every truncation or damage must give an InputError, never a half-grey image or a crash.
class Truncated : public testing::TestWithParam<const char*> {};

TEST_P(Truncated, EveryPrefixOfAnImageIsAnError) {
  const TempFolder folder;
  const std::string whole = encoded(make_color(5), GetParam());
  ASSERT_TRUE(image_damage(whole).empty()) << image_damage(whole);
  for (size_t size = 0; size < whole.size(); ++size) {
    ASSERT_FALSE(image_damage(std::string_view(whole).substr(0, size)).empty()) << size << " bytes";
  }
  const auto half = folder.write("half", std::string_view(whole).substr(0, whole.size() / 2));
  EXPECT_THAT(input_error([&] { read_color_image(half); }), HasSubstr("truncated"));
}

TEST_P(Truncated, BytesBehindTheEndDoNoHarm) {
  const TempFolder folder;
  const auto path = folder.write("long", encoded(make_color(5), GetParam()) + std::string(100, '\0'));
  EXPECT_EQ(read_color_image(path).size().width, test::kWidth);
}

INSTANTIATE_TEST_SUITE_P(Formats, Truncated, testing::Values(".png", ".jpg"),
                         [](const auto& format) { return std::string(format.param + 1); });

TEST(ImageDamage, ProgressiveJpegAndRestartMarkersAreWhole) {
  std::vector<uint8_t> bytes;
  cv::imencode(".jpg", make_color(2, CV_8UC3, {64, 64}), bytes,
               {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 2});
  EXPECT_EQ(image_damage({reinterpret_cast<const char*>(bytes.data()), bytes.size()}), "");
}

TEST(ImageDamage, FlippedBytesOfAPngAreNoticedByItsChecksums) {
  const TempFolder folder;
  std::string bytes = encoded(make_color(5), ".png");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  const auto path = folder.write("flipped.png", bytes);
  EXPECT_THAT(input_error([&] { read_color_image(path); }), HasSubstr("damaged"));
}

TEST(ImageDamage, OtherFilesAreNoImages) {
  const TempFolder folder;
  EXPECT_THAT(image_damage("hello"), HasSubstr("neither"));
  EXPECT_THAT(image_damage(""), HasSubstr("empty"));
  EXPECT_THAT(input_error([&] { read_color_image(folder.path() / "none.png"); }), HasSubstr("no such file"));
  EXPECT_THAT(input_error([&] { read_color_image(folder.path()); }), HasSubstr("not a regular file"));
}

TEST(ImageFile, WebpIsReadWhereTheLibraryIs) {
  const TempFolder folder;
  const cv::Mat color = make_color(1);
  std::vector<uint8_t> lossless;
  cv::imencode(".webp", color, lossless, {cv::IMWRITE_WEBP_QUALITY, 101});
  const std::string bytes(lossless.begin(), lossless.end());
  const auto path = folder.write("a.webp", bytes);
  if (!webp_available()) {
    EXPECT_THAT(input_error([&] { read_color_image(path); }), HasSubstr("a WebP image"));
    GTEST_SKIP() << "this build does not decode WebP";
  }
  EXPECT_EQ(encoded_size(bytes), color.size());
  EXPECT_EQ(cv::norm(read_color_image(path).bgr(), color, cv::NORM_INF), 0);
  for (size_t i = 0; i < bytes.size(); i += 7) {
    const auto cut = folder.write("cut.webp", std::string_view(bytes).substr(0, i));
    EXPECT_THAT(input_error([&] { read_color_image(cut); }), HasSubstr("cut.webp: ")) << i;
  }
}

TEST(ImageDamage, HeaderWithAbsurdSizeIsAnError) {
  const TempFolder folder;
  std::string bytes = encoded(make_color(5), ".png");
  bytes[16] = bytes[20] = '\x7f';  // the most significant bytes of width and height
  const auto path = folder.write("huge.png", bytes);
  EXPECT_THAT(input_error([&] { read_color_image(path); }), HasSubstr("huge.png"));
}

}  // namespace
}  // namespace kinloop
