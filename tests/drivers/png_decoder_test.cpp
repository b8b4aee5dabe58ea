#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <png.h>
#include <zlib.h>

#include "drivers/image_files/png.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/random.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using test::encoded;
using test::make_color;

double difference_of(const cv::Mat& a, const cv::Mat& b) {
  return a.type() == b.type() && a.size() == b.size() ? cv::norm(a, b, cv::NORM_INF) : 1e9;
}

cv::Mat read_by_opencv(const std::string& file, cv::ImreadModes mode) {
  return cv::imdecode(std::vector<char>(file.begin(), file.end()), mode);
}

/// How a PNG file is written.
struct PngForm {
  int bits = 8;
  int color_type = PNG_COLOR_TYPE_RGB;
  int filters = PNG_ALL_FILTERS;
  bool interlaced = false;
};

/// Writes random rows with some smoothness, by libpng; for palettes and bits below 8 the bytes are packed
/// pixels.
std::string png_file(int cols, int rows, const PngForm& form, uint64_t seed = 1) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  std::string file;
  png_set_write_fn(
      png, &file,
      [](png_structp to, png_bytep data, size_t size) {
        static_cast<std::string*>(png_get_io_ptr(to))->append(reinterpret_cast<char*>(data), size);
      },
      nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(cols), static_cast<png_uint_32>(rows), form.bits,
               form.color_type, form.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  Random random(seed);
  if (form.color_type == PNG_COLOR_TYPE_PALETTE) {
    std::vector<png_color> palette(size_t{1} << form.bits);
    for (auto& color : palette) {
      color = {static_cast<png_byte>(random.index(256)), static_cast<png_byte>(random.index(256)),
               static_cast<png_byte>(random.index(256))};
    }
    png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
  }
  png_set_filter(png, PNG_FILTER_TYPE_BASE, form.filters);
  png_write_info(png, info);
  const size_t row_bytes = png_get_rowbytes(png, info);
  std::vector<std::vector<uint8_t>> bytes(static_cast<size_t>(rows), std::vector<uint8_t>(row_bytes));
  std::vector<png_bytep> pointers;
  for (auto& row : bytes) {
    size_t value = random.index(256);
    for (auto& byte : row) byte = static_cast<uint8_t>(value += random.index(4) == 0 ? random.index(256) : 1);
    pointers.push_back(row.data());
  }
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return file;
}

constexpr PngForm kCommonForms[] = {{8, PNG_COLOR_TYPE_GRAY},
                                    {16, PNG_COLOR_TYPE_GRAY},
                                    {8, PNG_COLOR_TYPE_RGB},
                                    {8, PNG_COLOR_TYPE_RGB_ALPHA}};

/// What OpenCV reads, without transparency.
cv::Mat expected_pixels(const std::string& file) {
  const cv::Mat image = read_by_opencv(file, cv::IMREAD_UNCHANGED);
  if (image.channels() != 4) return image;
  cv::Mat bgr;
  cv::cvtColor(image, bgr, cv::COLOR_BGRA2BGR);
  return bgr;
}

TEST(DecodeCommonPng, EveryFilterAndWidthGivesWhatOpenCVReads) {
  uint64_t seed = 0;
  for (PngForm form : kCommonForms) {
    for (const int filters : {PNG_FILTER_NONE, PNG_FILTER_SUB, PNG_FILTER_UP, PNG_FILTER_AVG,
                              PNG_FILTER_PAETH, PNG_ALL_FILTERS}) {
      for (const cv::Size size : {cv::Size(1, 1), {1, 9}, {2, 3}, {3, 2}, {5, 1}, {31, 17}, {64, 33}}) {
        form.filters = filters;
        const std::string file = png_file(size.width, size.height, form, ++seed);
        EXPECT_EQ(difference_of(decode_common_png(file), expected_pixels(file)), 0)
            << form.bits << " bits, type " << form.color_type << ", filters " << filters << ", " << size;
      }
    }
  }
}

TEST(DecodeCommonPng, WhatIsWrittenIsReadBack) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    EXPECT_EQ(difference_of(decode_common_png(encoded(make_color(8, type), ".png")), make_color(8, type)), 0);
  }
  EXPECT_EQ(difference_of(decode_common_png(encoded(test::make_depth(900), ".png")), test::make_depth(900)),
            0);
}

TEST(DecodeCommonPng, RealDepthIsWhatOpenCVReads) {
  const std::filesystem::path folder = test::shared_data("redkitchen/depth");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const std::string file = read_file(folder / "1000.000000.png");
  EXPECT_EQ(difference_of(decode_common_png(file), read_by_opencv(file, cv::IMREAD_UNCHANGED)), 0);
}

TEST(DecodeCommonPng, LeavesOtherKindsToLibpng) {
  for (const PngForm& form :
       {PngForm{4, PNG_COLOR_TYPE_GRAY}, PngForm{8, PNG_COLOR_TYPE_PALETTE}, PngForm{16, PNG_COLOR_TYPE_RGB},
        PngForm{8, PNG_COLOR_TYPE_GRAY_ALPHA}, PngForm{8, PNG_COLOR_TYPE_RGB, PNG_ALL_FILTERS, true}}) {
    EXPECT_TRUE(decode_common_png(png_file(20, 10, form)).empty());
  }
  EXPECT_TRUE(decode_common_png(encoded(make_color(1), ".jpg")).empty());
  EXPECT_TRUE(decode_common_png("").empty());
}

TEST(DecodePng, EveryKindGivesWhatOpenCVReads) {
  for (const int type : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_PALETTE, PNG_COLOR_TYPE_RGB,
                         PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB_ALPHA}) {
    for (const int bits : {1, 2, 4, 8, 16}) {
      const bool valid = type == PNG_COLOR_TYPE_GRAY || bits == 8 ||
                         (type == PNG_COLOR_TYPE_PALETTE ? bits < 8 : bits == 16);
      if (!valid) continue;
      for (const bool interlaced : {false, true}) {
        const std::string file = png_file(37, 21, {bits, type, PNG_ALL_FILTERS, interlaced});
        const auto depth = bits == 16 ? CV_16U : CV_8U;
        cv::Mat theirs;
        read_by_opencv(
            file, bits == 16 ? cv::ImreadModes(cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH) : cv::IMREAD_COLOR)
            .convertTo(theirs, depth);
        cv::Mat ours = decode_png(file);
        ASSERT_EQ(ours.depth(), depth) << bits << " bits, type " << type;
        if (ours.channels() == 1) cv::cvtColor(ours, ours, cv::COLOR_GRAY2BGR);
        EXPECT_EQ(difference_of(ours, theirs), 0) << bits << " bits, type " << type << " " << interlaced;
      }
    }
  }
}

/// Each damage or truncation gives nothing: PNG has checksums.
TEST(DecodePng, DamagedAndTruncatedFilesGiveNothing) {
  for (PngForm form : kCommonForms) {
    for (const bool interlaced : {false, true}) {
      form.interlaced = interlaced;
      const std::string whole = png_file(50, 40, form);
      ASSERT_FALSE(decode_png(whole).empty());
      const size_t end = whole.size() - 12;  // of the data: the rest is IEND, which libpng need not read
      for (size_t at = 8; at < end; at += 61) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
        EXPECT_TRUE(decode_png(damaged).empty()) << at;
        EXPECT_TRUE(decode_png(std::string_view(whole).substr(0, at)).empty()) << at;
      }
    }
  }
}

TEST(DecodePng, AbsurdSizesAreRejectedFromTheHeader) {
  for (const bool interlaced : {false, true}) {
    std::string file = png_file(50, 40, {8, PNG_COLOR_TYPE_RGB, PNG_ALL_FILTERS, interlaced});
    constexpr size_t kHeader = 12;  // of the file: type and data of IHDR
    file[kHeader + 6] = '\x7f';     // width and height become 32562 and 32552, 3 GB of pixels
    file[kHeader + 10] = '\x7f';
    const auto checksum = crc32(0, reinterpret_cast<const Bytef*>(file.data() + kHeader), 17);
    for (size_t i = 0; i < 4; ++i) file[kHeader + 17 + i] = static_cast<char>(checksum >> (24 - 8 * i));
    EXPECT_TRUE(decode_png(file).empty());
    EXPECT_TRUE(decode_png_with_libpng(file).empty());
  }
}

}  // namespace
}  // namespace kinloop
