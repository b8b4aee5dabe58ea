// Depth images in the formats of numbers: EXR, TIFF, NumPy, OpenCV's YAML.

#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <sys/resource.h>
#include <tiffio.h>

#include "drivers/datasets/reading/images/depth_image.hpp"
#include "drivers/images/depth_files/depth_file.hpp"
#include "kinloop/core/errors.hpp"
#include "tests/drivers/depth_file_samples.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

/// Depth with noise, so that nothing in it repeats, in millimetres.
cv::Mat noisy_mm(cv::Size size = {67, 41}) {
  cv::Mat depth(size, CV_16UC1);
  cv::RNG random(5);
  random.fill(depth, cv::RNG::UNIFORM, 0, 5000);
  depth.rowRange(0, size.height / 2).setTo(1500);
  return depth;
}

cv::Mat converted(const cv::Mat& image, int type, double scale = 1) {
  cv::Mat result;
  image.convertTo(result, type, scale);
  return result;
}

void expect_same(const cv::Mat& image, const cv::Mat& expected) {
  ASSERT_EQ(image.type(), expected.type());
  ASSERT_EQ(image.size(), expected.size());
  EXPECT_EQ(cv::norm(image, expected, cv::NORM_INF), 0);
}

void expect_decoded(const std::string& bytes, const cv::Mat& expected) {
  EXPECT_EQ(depth_file_size(bytes), expected.size());
  expect_same(decode_depth_file(bytes), expected);
}

TEST(DepthFiles, ExrIsReadAsOpenExrWritesIt) {
  constexpr double kLossOfB44 = 0.5;  // it keeps 4 x 4 pixels in 14 bytes
  cv::Mat expected(6, 8, CV_32FC1);
  for (int y = 0; y < expected.rows; ++y) {
    for (int x = 0; x < expected.cols; ++x)
      expected.at<float>(y, x) = 0.5F + 0.25F * static_cast<float>(x) + static_cast<float>(y);
  }
  expected.at<float>(0, 0) = 0;
  for (const test::ExrSample& sample : test::exr_samples()) {
    SCOPED_TRACE(sample.compression);
    EXPECT_EQ(depth_file_size(sample.bytes), expected.size());
    const cv::Mat image = decode_depth_file(sample.bytes);
    ASSERT_EQ(image.type(), CV_32FC1);
    EXPECT_LE(cv::norm(image, expected, cv::NORM_INF),
              std::string_view(sample.compression) == "B44" ? kLossOfB44 : 0);
  }
}

TEST(DepthFiles, ExrIsReadWhereItsBlocksAreSmallerThanTheirPixels) {
  constexpr double kLossOfDwaa = 0.02;  // of values up to 2.3
  cv::Mat expected(64, 64, CV_32FC1);
  for (int y = 0; y < expected.rows; ++y) {
    for (int x = 0; x < expected.cols; ++x)
      expected.at<float>(y, x) =
          1.0F + static_cast<float>(x) / 64 + static_cast<float>(y) / 128;  // as halves
  }
  for (const auto compression : {Imf::PIZ_COMPRESSION, Imf::DWAA_COMPRESSION}) {
    SCOPED_TRACE(compression);
    const std::string bytes = test::exr_of_halves(expected, compression);
    EXPECT_LT(bytes.size(), expected.total() * sizeof(uint16_t));  // else stored as they are, header and all
    EXPECT_LE(cv::norm(decode_depth_file(bytes), expected, cv::NORM_INF),
              compression == Imf::DWAA_COMPRESSION ? kLossOfDwaa : 0);
  }
}

TEST(DepthFiles, TilesOfExrThatNoImageHasAreRefusedBeforeMemoryIsAllocated) {
  std::string tiled;
  for (const test::ExrSample& sample : test::exr_samples())
    if (std::string_view(sample.compression) == "ZIP_tiled") tiled = sample.bytes;
  const size_t tiles = tiled.find(std::string_view("tiledesc\0", 9));
  ASSERT_NE(tiles, std::string::npos);
  const size_t columns = tiles + 9 + 4;
  const std::string wide = std::string(tiled).replace(columns, 4, std::string_view("\x00\x00\x00\x10", 4));
  EXPECT_THAT(input_error([&] { decode_depth_file(wide); }), HasSubstr("an image of 268435456 x 4 pixels"));
  // OpenEXR allocates a row of tiles as wide as the image, not as the tile.
  const std::string high =
      std::string(tiled).replace(columns, 8, std::string_view("\x01\0\0\0\x31\x75\0\0", 8));
  EXPECT_THAT(input_error([&] { decode_depth_file(high); }), HasSubstr("an image of 1 x 30001 pixels"));
}

constexpr long kMost_kib = 1 << 18;

/// The most memory that this process has used so far.
long peak_kib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

TEST(DepthFiles, AttributesOfExrBeyondItsEndAreRefusedBeforeMemoryIsAllocated) {
  constexpr std::string_view kAttribute("compression\0compression\0", 24),
      kUnknown("own_remarks\0own_remarks\0", 24);
  std::string bytes = test::exr_samples().front().bytes;
  const size_t at = bytes.find(kAttribute);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, kUnknown.size(), kUnknown);
  bytes.replace(at + kUnknown.size(), 4, std::string_view("\0\0\0\x7f", 4));  // 2 GB
  const long before_kib = peak_kib();
  EXPECT_THAT(input_error([&] { decode_depth_file(bytes); }), HasSubstr("damaged or truncated"));
  EXPECT_LT(peak_kib() - before_kib, kMost_kib);
}

TEST(DepthFiles, ChannelsOfExrThatDoNotEndAreRefusedBeforeMemoryIsAllocated) {
  constexpr std::string_view kType("chlist\0", 7);
  const long before_kib = peak_kib();
  for (const test::ExrSample& sample : test::exr_samples()) {
    SCOPED_TRACE(sample.compression);
    const size_t list = sample.bytes.find(kType) + kType.size() + sizeof(uint32_t);
    const size_t first = sample.bytes.find('\0', list) + 1;
    const std::string longer = std::string(sample.bytes).insert(first + 2, "\xff\xff\xff\xef");
    EXPECT_THAT(input_error([&] { decode_depth_file(longer); }), HasSubstr("damaged"));
  }
  EXPECT_LT(peak_kib() - before_kib, kMost_kib);
}

TEST(DepthFiles, ExrOfSeveralBlocksKeepsEachFloat) {
  const cv::Mat depth_m = converted(noisy_mm({256, 192}), CV_32FC1, 0.001);
  expect_decoded(test::exr(depth_m), depth_m);
}

TEST(DepthFiles, TiffIsReadInEachCompression) {
  constexpr int kNone = 1, kLzw = 5, kDeflate = 8, kPackBits = 32773;
  const cv::Mat units = noisy_mm({256, 192}), metres = converted(units, CV_32FC1, 0.001);
  for (const int compression : {kNone, kLzw, kDeflate, kPackBits}) {
    SCOPED_TRACE(compression);
    expect_decoded(test::tiff(units, compression), units);
    expect_decoded(test::tiff(metres, compression), metres);
  }
  expect_decoded(test::tiff(converted(units, CV_64FC1), kNone), converted(units, CV_32FC1));
  EXPECT_THAT(input_error([&] { decode_depth_file(test::tiff(converted(units, CV_8UC1), kNone)); }),
              HasSubstr("a TIFF of 8 bits and 1 channels"));
}

TEST(DepthFiles, TiffIsReadInStripsAndTilesOfEveryKind) {
  constexpr uint16_t kNone = 1, kLzw = 5, kDeflate = 8, kZstd = 50000, kLzma = 34925;
  constexpr uint16_t kDifferences = 2, kPlanes = 3;
  const cv::Mat units = noisy_mm(), metres = converted(units, CV_32FC1, 0.001);
  for (const int tile_px : {0, 16, 128}) {
    for (const char* mode : {"wl", "wb", "w8l", "w8b"}) {
      for (const uint16_t compression : {kNone, kLzw, kDeflate}) {
        SCOPED_TRACE(testing::Message() << tile_px << " " << mode << " " << compression);
        test::TiffLayout layout{.compression = compression, .tile_px = tile_px, .mode = mode};
        if (compression != kNone) layout.predictor = kDifferences;
        expect_decoded(test::tiff_by_libtiff(units, layout), units);
        // The planes of big-endian files are in the wrong order as libtiff 4.5 writes them.
        const bool is_big_endian = std::string_view(mode).ends_with("b");
        if (compression != kNone) layout.predictor = is_big_endian ? kDifferences : kPlanes;
        expect_decoded(test::tiff_by_libtiff(metres, layout), metres);
      }
    }
  }
  for (const uint16_t compression : {kZstd, kLzma})
    if (TIFFIsCODECConfigured(compression) != 0)
      expect_decoded(test::tiff_by_libtiff(metres, {.compression = compression}), metres);
  for (const int type : {CV_16SC1, CV_32SC1, CV_64FC1})
    expect_decoded(test::tiff_by_libtiff(converted(units, type), {}), converted(units, CV_32FC1));
}

TEST(DepthFiles, TiffOfSeveralPagesIsRefusedUnlessTheyAreCopies) {
  constexpr uint32_t kPage = 0, kReduced = 1, kMask = 4;
  const cv::Mat units = noisy_mm();
  expect_decoded(test::tiff_by_libtiff(units, {.kinds_of_pages = {kPage, kReduced, kMask}}), units);
  for (const auto& kinds :
       {std::vector{kPage, kPage}, std::vector{kPage, kReduced, kPage}, std::vector(18, kReduced)}) {
    const std::string bytes = test::tiff_by_libtiff(units, {.kinds_of_pages = kinds});
    EXPECT_THAT(input_error([&] { decode_depth_file(bytes); }), HasSubstr("a TIFF of several pages"));
    EXPECT_THAT(input_error([&] { depth_file_size(bytes); }), HasSubstr("a TIFF of several pages"));
  }
}

/// Replaces the value of a tag of the first page of a little-endian TIFF file, or its offset if it is long.
std::string with_tag(std::string bytes, uint16_t tag, uint32_t value) {
  uint32_t directory = 0;
  std::memcpy(&directory, &bytes[4], sizeof directory);
  for (size_t entry = directory + 2;; entry += 12) {
    if (entry + 12 > bytes.size()) throw std::logic_error("no such tag");
    if (std::memcmp(&bytes[entry], &tag, sizeof tag) != 0) continue;
    std::memcpy(&bytes[entry + 8], &value, sizeof value);
    return bytes;
  }
}

TEST(DepthFiles, CraftedTiffEndsWithAMessage) {
  constexpr uint16_t kWidth = 256, kCompression = 259, kStripOffsets = 273, kRowsPerStrip = 278,
                     kTileWidth = 322, kTileOffsets = 324;
  constexpr uint32_t kPixarLog = 32909, kFar = 0x7fffffff;
  const cv::Mat units = noisy_mm();
  const std::string strips = test::tiff_by_libtiff(units, {.mode = "wl"}),
                    tiles = test::tiff_by_libtiff(units, {.tile_px = 16, .mode = "wl"});
  const auto error = [&](const std::string& bytes) { return input_error([&] { decode_depth_file(bytes); }); };
  EXPECT_THAT(error(with_tag(strips, kWidth, 40000)), HasSubstr("an image of 40000 x 41 pixels"));
  EXPECT_THAT(error(with_tag(tiles, kTileWidth, 40000)), HasSubstr("an image of 40000 x 16 pixels"));
  EXPECT_THAT(error(with_tag(strips, kCompression, kPixarLog)), HasSubstr("compression 32909"));
  for (const std::string& bytes : {with_tag(strips, kWidth, 2000), with_tag(strips, kRowsPerStrip, 0),
                                   with_tag(strips, kStripOffsets, kFar), with_tag(tiles, kTileOffsets, kFar),
                                   strips.substr(0, strips.size() / 2), std::string("II*\0", 4)})
    EXPECT_THAT(error(bytes), HasSubstr("the TIFF file is damaged or truncated; copy it again"));
  std::string loop = test::tiff_by_libtiff(units, {.mode = "wl", .kinds_of_pages = {1}});
  uint32_t directory = 0;
  uint16_t count = 0;
  std::memcpy(&directory, &loop[4], sizeof directory);
  std::memcpy(&count, &loop[directory], sizeof count);
  std::memcpy(&loop[directory + 2 + 12 * size_t{count}], &directory, sizeof directory);  // it follows itself
  EXPECT_THAT(error(loop), HasSubstr("damaged"));
}

TEST(DepthFiles, TiffIsReadInEitherByteOrder) {
  const std::string bytes(
      "MM\0\x2a\0\0\0\x0c\x03\xe8\x07\xd0"  // the pixels 1000 and 2000 at byte 8
      "\0\x07\x01\0\0\x03\0\0\0\1\0\2\0\0\x01\x01\0\x03\0\0\0\1\0\1\0\0\x01\x02\0\x03\0\0\0\1\0\x10\0\0"
      "\x01\x03\0\x03\0\0\0\1\0\1\0\0\x01\x11\0\x04\0\0\0\1\0\0\0\x08\x01\x16\0\x03\0\0\0\1\0\1\0\0"
      "\x01\x17\0\x04\0\0\0\1\0\0\0\x04\0\0\0\0",
      12 + 2 + 7 * 12 + 4);
  expect_decoded(bytes, (cv::Mat_<uint16_t>(1, 2) << 1000, 2000));
}

TEST(DepthFiles, NumpyArraysMayHaveAnyUsualType) {
  const cv::Mat units = noisy_mm();
  expect_decoded(test::numpy(units), units);
  for (const int type : {CV_16SC1, CV_32SC1, CV_32FC1, CV_64FC1}) {
    SCOPED_TRACE(type);
    expect_decoded(test::numpy(converted(units, type)), converted(units, CV_32FC1));
  }
  std::string flat = test::numpy(units), columns = flat, bytes = flat;
  flat.replace(flat.find("(41, 67)"), 8, "(2747,) ");
  columns.replace(columns.find("False"), 5, "True ");
  bytes.replace(bytes.find("<u2"), 3, ">u2");
  EXPECT_THAT(input_error([&] { decode_depth_file(flat); }), HasSubstr("two dimensions"));
  EXPECT_THAT(input_error([&] { decode_depth_file(columns); }), HasSubstr("not in C order"));
  EXPECT_THAT(input_error([&] { decode_depth_file(bytes); }), HasSubstr("an array of '>u2'"));
}

TEST(DepthFiles, ArchiveOfNumpyHoldsOneArrayOrOneCalledDepth) {
  const cv::Mat units = noisy_mm();
  const std::string depth = test::numpy(units), other = test::numpy(converted(units, CV_32FC1));
  for (const bool deflated : {false, true}) {
    expect_decoded(test::numpy_archive({{"arr_0.npy", depth}}, deflated), units);
    expect_decoded(test::numpy_archive({{"mask.npy", other}, {"depth.npy", depth}}, deflated), units);
  }
  const std::string two = test::numpy_archive({{"a.npy", other}, {"b.npy", depth}}, true);
  EXPECT_THAT(input_error([&] { decode_depth_file(two); }),
              HasSubstr("2 arrays, none of which is called depth"));
}

TEST(DepthFiles, YamlIsReadAsOpenCvWritesIt) {
  const cv::Mat units = noisy_mm();
  expect_decoded(test::opencv_yaml(units), units);
  cv::Mat metres = converted(units, CV_32FC1, 0.001);
  metres.at<float>(3, 4) = std::numeric_limits<float>::quiet_NaN();
  metres.at<float>(3, 5) = std::numeric_limits<float>::infinity();
  const std::string bytes = test::opencv_yaml(metres);
  metres.at<float>(3, 4) = metres.at<float>(3, 5) = 0;
  expect_decoded(bytes, metres);
}

TEST(DepthFiles, WithoutAPositiveFiniteNumberDepthIsUnknown) {
  cv::Mat metres = converted(noisy_mm(), CV_32FC1, 0.001);
  metres.at<float>(0, 1) = -1;
  metres.at<float>(0, 2) = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat depth_m = decode_depth(test::numpy(metres), "a.npy", DepthEncoding::kFloatImage, {}, 5000);
  EXPECT_EQ(depth_m.at<float>(0, 0), metres.at<float>(0, 0));
  EXPECT_EQ(depth_m.at<float>(0, 1), 0);
  EXPECT_EQ(depth_m.at<float>(0, 2), 0);
  EXPECT_THAT(input_error([&] { decode_depth("x", "a.npy", DepthEncoding::kFloatImage, {}, 1); }),
              HasSubstr("a.npy: "));
}

TEST(DepthFiles, SizesThatNoImageHasAreRefusedBeforeMemoryIsAllocated) {
  std::string array = test::numpy(noisy_mm()), yaml = test::opencv_yaml(noisy_mm());
  array.replace(array.find("(41, 67)"), 8, "(29999,29999)");
  yaml.replace(yaml.find("cols: 67"), 8, "cols: 67000000");
  for (const std::string& bytes : {array, yaml})
    EXPECT_THAT(input_error([&] { decode_depth_file(bytes); }), HasSubstr("an image of "));
}

TEST(DepthFiles, DamagedOnesAreRefusedOrRead) {
  const cv::Mat mm = noisy_mm({13, 9});
  for (const test::DepthFormat& format : test::depth_formats()) {
    SCOPED_TRACE(format.name);
    const std::string whole = format.write(mm);
    if (!format.writes_numbers) continue;
    ASSERT_TRUE(is_depth_file(whole));
    const auto try_bytes = [](const std::string& bytes) {
      try {
        static_cast<void>(depth_file_size(bytes));
        const cv::Mat image = decode_depth_file(bytes);
        EXPECT_TRUE(image.type() == CV_16UC1 || image.type() == CV_32FC1);
      } catch (const InputError& error) {
        EXPECT_THAT(std::string(error.what()), testing::Not(HasSubstr("\n")));
      }
    };
    for (size_t size = 0; size < whole.size(); size += 1 + whole.size() / 300)
      try_bytes(whole.substr(0, size));
    Random random(3);
    for (int i = 0; i < test::mutations(500); ++i) try_bytes(test::mutated(whole, random));
  }
}

}  // namespace
}  // namespace kinloop
