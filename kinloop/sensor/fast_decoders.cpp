#include "kinloop/sensor/fast_decoders.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <libdeflate.h>

namespace kinloop {
namespace {

using namespace std::string_view_literals;

/// Reads a big-endian 32-bit number.
uint32_t number_at(std::string_view bytes, size_t position) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<uint8_t>(bytes[position + i]);
  return value;
}

/// The content of a PNG file: its size and its filtered rows, still deflated.
struct PngContent {
  int width = 0, height = 0;
  std::string deflated;
};

/// Returns the content of a non-interlaced 16-bit grey PNG file (PNG specification, sections 5.3 and 11.2.2).
std::optional<PngContent> depth_png_content(std::string_view bytes) {
  constexpr size_t kSignature = 8, kFrame = 12;       // a chunk adds length, type and checksum to its data
  constexpr auto kSixteenBitGrey = "\x10\0\0\0\0"sv;  // depth, colour type, compression, filter, interlace
  constexpr uint32_t kHeaderBytes = 13, kMaxSide = 1U << 15;
  PngContent content;
  for (size_t at = kSignature; at + kFrame <= bytes.size();) {
    const uint32_t length = number_at(bytes, at);
    if (length > bytes.size() - at - kFrame) return std::nullopt;
    const auto type = bytes.substr(at + 4, 4), data = bytes.substr(at + 8, length);
    if (libdeflate_crc32(0, type.data(), 4 + length) != number_at(bytes, at + 8 + length))
      return std::nullopt;
    if (type == "IHDR") {
      if (length != kHeaderBytes || data.substr(8) != kSixteenBitGrey) return std::nullopt;
      if (number_at(data, 0) > kMaxSide || number_at(data, 4) > kMaxSide) return std::nullopt;
      content.width = static_cast<int>(number_at(data, 0));
      content.height = static_cast<int>(number_at(data, 4));
    } else if (type == "IDAT") {
      content.deflated += data;
    } else if (type == "IEND") {
      return content;
    }
    at += kFrame + length;
  }
  return std::nullopt;
}

constexpr size_t kPixelBytes = 2;

/// Undoes one of the four filters on one row; `predict` predicts a byte from the bytes of the pixels to the
/// left, above, and above left.
template <class Predict>
void unfilter(uint8_t* row, const uint8_t* above, size_t size, const Predict& predict) {
  static_assert(kPixelBytes == 2);
  int left_high = 0, left_low = 0, corner_high = 0, corner_low = 0;  // in registers, since rows may alias
  for (size_t i = 0; i + 1 < size; i += kPixelBytes) {
    const int up_high = above[i], up_low = above[i + 1];
    left_high = (row[i] + predict(left_high, up_high, corner_high)) & 0xFF;
    left_low = (row[i + 1] + predict(left_low, up_low, corner_low)) & 0xFF;
    row[i] = static_cast<uint8_t>(left_high);
    row[i + 1] = static_cast<uint8_t>(left_low);
    corner_high = up_high;
    corner_low = up_low;
  }
}

/// Whichever of left, above and above left is nearest to left + above - above left.
int paeth(int left, int above, int corner) {
  const int to_left = std::abs(above - corner), to_above = std::abs(left - corner);
  const int to_corner = std::abs(left + above - 2 * corner);
  const int nearer = to_above <= to_corner ? above : corner;
  return to_left <= std::min(to_above, to_corner) ? left : nearer;
}

/// Undoes the filter with number `filter` (PNG specification, section 9.2); returns false for an unknown
/// filter.
bool unfilter(int filter, uint8_t* row, const uint8_t* above, size_t size) {
  switch (filter) {
    case 0:
      return true;
    case 1:
      unfilter(row, above, size, [](int left, int, int) { return left; });
      return true;
    case 2:
      unfilter(row, above, size, [](int, int up, int) { return up; });
      return true;
    case 3:
      unfilter(row, above, size, [](int left, int up, int) { return (left + up) / 2; });
      return true;
    case 4:
      unfilter(row, above, size, paeth);
      return true;
    default:
      return false;
  }
}

std::optional<std::vector<uint8_t>> inflate(const std::string& deflated, size_t size) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!decompressor) return std::nullopt;
  std::vector<uint8_t> bytes(size);
  size_t written = 0;
  const auto result = libdeflate_zlib_decompress(decompressor.get(), deflated.data(), deflated.size(),
                                                 bytes.data(), size, &written);
  if (result != LIBDEFLATE_SUCCESS || written != size) return std::nullopt;
  return bytes;
}

}  // namespace

cv::Mat decode_depth_png(std::string_view bytes) {
  const auto content = depth_png_content(bytes);
  if (!content || content->width == 0 || content->height == 0) return {};
  constexpr size_t kMaxInflation = 1032;  // highest ratio of any deflated stream; more means a damaged header
  const size_t row_bytes = kPixelBytes * static_cast<size_t>(content->width);
  const size_t size = (1 + row_bytes) * static_cast<size_t>(content->height);
  if (size > kMaxInflation * content->deflated.size()) return {};
  auto rows = inflate(content->deflated, size);
  if (!rows) return {};
  cv::Mat image(content->height, content->width, CV_16UC1);
  const std::vector<uint8_t> nothing(row_bytes, 0);
  const uint8_t* above = nothing.data();
  for (int y = 0; y < image.rows; ++y) {
    uint8_t* row = rows->data() + static_cast<size_t>(y) * (1 + row_bytes) + 1;  // skips the filter byte
    if (!unfilter(row[-1], row, above, row_bytes)) return {};
    above = row;
    auto* pixels = image.ptr<uint16_t>(y);
    for (int x = 0; x < image.cols; ++x) {
      pixels[x] = static_cast<uint16_t>(row[kPixelBytes * static_cast<size_t>(x)] << 8 |
                                        row[kPixelBytes * static_cast<size_t>(x) + 1]);
    }
  }
  return image;
}

}  // namespace kinloop
