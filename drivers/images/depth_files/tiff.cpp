#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include <fmt/format.h>

#include "drivers/image_files/tiff_file.hpp"
#include "drivers/images/depth_files/depth_file.hpp"
#include "drivers/images/depth_files/depth_formats.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// Throws if there is a second image that is not a smaller copy or a mask of the first.
void require_single_page(const TiffFile& file) {
  constexpr uint32_t kNotPages = FILETYPE_REDUCEDIMAGE | FILETYPE_MASK;
  constexpr int kMostCopies = 16;
  for (int i = 0; TIFFLastDirectory(file.get()) == 0; ++i) {
    if (TIFFReadDirectory(file.get()) == 0) reject_damaged_tiff();
    if (i == kMostCopies || (tiff_value<uint32_t>(file, TIFFTAG_SUBFILETYPE) & kNotPages) == 0)
      throw InputError("a TIFF of several pages; write each depth image to a file of its own");
  }
  if (TIFFSetDirectory(file.get(), 0) == 0) reject_damaged_tiff();
}

/// Throws unless libtiff reads the compression, with every pixel kept.
void require_known_compression(const TiffFile& file) {
  constexpr std::array kKnown = {COMPRESSION_NONE,    COMPRESSION_LZW,      COMPRESSION_ADOBE_DEFLATE,
                                 COMPRESSION_DEFLATE, COMPRESSION_PACKBITS, COMPRESSION_ZSTD,
                                 COMPRESSION_LZMA};
  const auto compression = tiff_value<uint16_t>(file, TIFFTAG_COMPRESSION);
  const bool known = std::find(kKnown.begin(), kKnown.end(), compression) != kKnown.end();
  if (known && TIFFIsCODECConfigured(compression) != 0) return;
  throw InputError(fmt::format(
      "a TIFF with compression {}, which kinloop cannot read; write it with Deflate or none", compression));
}

/// Returns the type of pixels that libtiff delivers.
int tiff_pixel_type(const TiffFile& file) {
  struct Kind {
    uint16_t format, bits;
    int type;
  };
  constexpr std::array kKinds = {
      Kind{SAMPLEFORMAT_UINT, 16, CV_16UC1},   Kind{SAMPLEFORMAT_INT, 16, CV_16SC1},
      Kind{SAMPLEFORMAT_UINT, 32, CV_32SC1},   Kind{SAMPLEFORMAT_INT, 32, CV_32SC1},
      Kind{SAMPLEFORMAT_IEEEFP, 32, CV_32FC1}, Kind{SAMPLEFORMAT_IEEEFP, 64, CV_64FC1}};
  const auto format = tiff_value<uint16_t>(file, TIFFTAG_SAMPLEFORMAT),
             bits = tiff_value<uint16_t>(file, TIFFTAG_BITSPERSAMPLE),
             channels = tiff_value<uint16_t>(file, TIFFTAG_SAMPLESPERPIXEL);
  const auto* const kind = std::find_if(kKinds.begin(), kKinds.end(), [&](const Kind& known) {
    return channels == 1 && known.format == format && known.bits == bits;
  });
  if (kind != kKinds.end()) return kind->type;
  throw InputError(
      fmt::format("a TIFF of {} bits and {} channels; write depth as one channel of 16 bits or 32-bit floats",
                  bits, channels));
}

/// The size of a depth image. Throws unless its pixels can be read.
cv::Size depth_tiff_size(const TiffFile& file) {
  const cv::Size size = tiff_image_size(file);
  static_cast<void>(tiff_pixel_type(file));
  require_known_compression(file);
  require_single_page(file);
  return size;
}

void read_tiles(const TiffFile& file, cv::Mat& image) {
  const cv::Size size = checked_depth_size(tiff_value<uint32_t>(file, TIFFTAG_TILEWIDTH),
                                           tiff_value<uint32_t>(file, TIFFTAG_TILELENGTH));
  cv::Mat tile(size, image.type());
  const auto bytes = static_cast<tmsize_t>(tile.total() * tile.elemSize());
  for (int y = 0; y < image.rows; y += size.height) {
    for (int x = 0; x < image.cols; x += size.width) {
      const uint32_t index =
          TIFFComputeTile(file.get(), static_cast<uint32_t>(x), static_cast<uint32_t>(y), 0, 0);
      if (TIFFReadEncodedTile(file.get(), index, tile.data, bytes) != bytes) reject_damaged_tiff();
      const cv::Rect inside = cv::Rect({x, y}, size) & cv::Rect({0, 0}, image.size());
      tile(cv::Rect({0, 0}, inside.size())).copyTo(image(inside));
    }
  }
}

void read_strips(const TiffFile& file, cv::Mat& image) {
  const auto given = tiff_value<uint32_t>(file, TIFFTAG_ROWSPERSTRIP);
  if (given == 0) reject_damaged_tiff();
  const int rows = static_cast<int>(std::min(given, static_cast<uint32_t>(image.rows)));
  for (int y = 0; y < image.rows; y += rows) {
    cv::Mat strip = image.rowRange(y, std::min(y + rows, image.rows));
    const auto bytes = static_cast<tmsize_t>(strip.total() * strip.elemSize());
    const uint32_t index = TIFFComputeStrip(file.get(), static_cast<uint32_t>(y), 0);
    if (TIFFReadEncodedStrip(file.get(), index, strip.data, bytes) != bytes) reject_damaged_tiff();
  }
}

}  // namespace

cv::Size tiff_size(std::string_view bytes) {
  TiffMemory memory{bytes};
  return depth_tiff_size(open_tiff(memory));
}

cv::Mat decode_tiff(std::string_view bytes) {
  TiffMemory memory{bytes};
  const TiffFile file = open_tiff(memory);
  const cv::Size size = depth_tiff_size(file);
  cv::Mat image(size, tiff_pixel_type(file));
  if (TIFFIsTiled(file.get()) != 0) {
    read_tiles(file, image);
  } else {
    read_strips(file, image);
  }
  if (image.type() != CV_16UC1) image.convertTo(image, CV_32F);
  return image;
}

}  // namespace kinloop
