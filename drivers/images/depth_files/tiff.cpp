#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <tiffio.h>

#include "drivers/images/depth_files/depth_file.hpp"
#include "drivers/images/depth_files/depth_formats.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {
namespace {

using TiffFile = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

[[noreturn]] void reject_damaged() {
  throw InputError("the TIFF file is damaged or truncated; copy it again");
}

/// The bytes of a file as libtiff reads them.
struct TiffMemory {
  std::string_view bytes;
  uint64_t at = 0;
};

tmsize_t read_memory(thandle_t handle, void* to, tmsize_t count) {
  auto& memory = *static_cast<TiffMemory*>(handle);
  if (count <= 0 || memory.at >= memory.bytes.size()) return 0;
  const size_t size = std::min(static_cast<size_t>(count), memory.bytes.size() - memory.at);
  std::memcpy(to, memory.bytes.data() + memory.at, size);
  memory.at += size;
  return static_cast<tmsize_t>(size);
}

tmsize_t refuse_to_write(thandle_t /*handle*/, void* /*from*/, tmsize_t /*count*/) {
  return 0;
}

toff_t seek_memory(thandle_t handle, toff_t offset, int whence) {
  auto& memory = *static_cast<TiffMemory*>(handle);
  const uint64_t from = whence == SEEK_CUR ? memory.at : whence == SEEK_END ? memory.bytes.size() : 0;
  return memory.at = from + offset;
}

int keep_open(thandle_t /*handle*/) {
  return 0;
}

toff_t size_of_memory(thandle_t handle) {
  return static_cast<TiffMemory*>(handle)->bytes.size();
}

int map_memory(thandle_t handle, void** base, toff_t* size) {
  const std::string_view bytes = static_cast<TiffMemory*>(handle)->bytes;
  *base = const_cast<char*>(bytes.data());  // libtiff does not write to a file opened for reading
  *size = bytes.size();
  return 1;
}

void unmap_memory(thandle_t /*handle*/, void* /*base*/, toff_t /*size*/) {}

/// Opens the first image, without messages on stderr. The memory must outlive the result.
TiffFile open_tiff(TiffMemory& memory) {
  constexpr const char *kName = "TIFF", *kRead = "r";
#if TIFFLIB_VERSION >= 20221213  // 4.5.0
  constexpr uint64_t kMostBytes = kMaxDecodedPixels * sizeof(double);
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(
      require_memory(TIFFOpenOptionsAlloc()), TIFFOpenOptionsFree);
  constexpr TIFFErrorHandlerExtR kSilent = [](TIFF*, void*, const char*, const char*, va_list) { return 1; };
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), static_cast<tmsize_t>(kMostBytes));
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), kSilent, nullptr);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), kSilent, nullptr);
  TiffFile file(TIFFClientOpenExt(kName, kRead, &memory, read_memory, refuse_to_write, seek_memory, keep_open,
                                  size_of_memory, map_memory, unmap_memory, options.get()),
                TIFFClose);
#else
  // Before 4.5, handlers are those of the process.
  static const std::array kBefore = {TIFFSetErrorHandler(nullptr), TIFFSetWarningHandler(nullptr)};
  static_cast<void>(kBefore);
  TiffFile file(TIFFClientOpen(kName, kRead, &memory, read_memory, refuse_to_write, seek_memory, keep_open,
                               size_of_memory, map_memory, unmap_memory),
                TIFFClose);
#endif
  if (!file) reject_damaged();
  return file;
}

/// Returns the value of a tag, or its default; 0 without either.
template <class Value>
Value tiff_value(const TiffFile& file, uint32_t tag) {
  Value value{};
  TIFFGetFieldDefaulted(file.get(), tag, &value);
  return value;
}

/// Throws if there is a second image that is not a smaller copy or a mask of the first.
void require_single_page(const TiffFile& file) {
  constexpr uint32_t kNotPages = FILETYPE_REDUCEDIMAGE | FILETYPE_MASK;
  constexpr int kMostCopies = 16;
  for (int i = 0; TIFFLastDirectory(file.get()) == 0; ++i) {
    if (TIFFReadDirectory(file.get()) == 0) reject_damaged();
    if (i == kMostCopies || (tiff_value<uint32_t>(file, TIFFTAG_SUBFILETYPE) & kNotPages) == 0)
      throw InputError("a TIFF of several pages; write each depth image to a file of its own");
  }
  if (TIFFSetDirectory(file.get(), 0) == 0) reject_damaged();
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

/// An image without its pixels.
cv::Size tiff_image_size(const TiffFile& file) {
  const cv::Size size = checked_depth_size(tiff_value<uint32_t>(file, TIFFTAG_IMAGEWIDTH),
                                           tiff_value<uint32_t>(file, TIFFTAG_IMAGELENGTH));
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
      if (TIFFReadEncodedTile(file.get(), index, tile.data, bytes) != bytes) reject_damaged();
      const cv::Rect inside = cv::Rect({x, y}, size) & cv::Rect({0, 0}, image.size());
      tile(cv::Rect({0, 0}, inside.size())).copyTo(image(inside));
    }
  }
}

void read_strips(const TiffFile& file, cv::Mat& image) {
  const auto given = tiff_value<uint32_t>(file, TIFFTAG_ROWSPERSTRIP);
  if (given == 0) reject_damaged();
  const int rows = static_cast<int>(std::min(given, static_cast<uint32_t>(image.rows)));
  for (int y = 0; y < image.rows; y += rows) {
    cv::Mat strip = image.rowRange(y, std::min(y + rows, image.rows));
    const auto bytes = static_cast<tmsize_t>(strip.total() * strip.elemSize());
    const uint32_t index = TIFFComputeStrip(file.get(), static_cast<uint32_t>(y), 0);
    if (TIFFReadEncodedStrip(file.get(), index, strip.data, bytes) != bytes) reject_damaged();
  }
}

}  // namespace

cv::Size tiff_size(std::string_view bytes) {
  TiffMemory memory{bytes};
  return tiff_image_size(open_tiff(memory));
}

cv::Mat decode_tiff(std::string_view bytes) {
  TiffMemory memory{bytes};
  const TiffFile file = open_tiff(memory);
  const cv::Size size = tiff_image_size(file);
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
