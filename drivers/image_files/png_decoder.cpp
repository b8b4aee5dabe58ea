#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <libdeflate.h>
#include <opencv2/imgproc.hpp>

#include "drivers/image_files/png.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {
namespace {

using namespace std::string_view_literals;

/// The last bytes of a header: depth, colour type, compression, filter, interlace.
constexpr auto kGrey8 = "\x8\0\0\0\0"sv, kGrey16 = "\x10\0\0\0\0"sv, kRgb8 = "\x8\x2\0\0\0"sv,
               kRgba8 = "\x8\x6\0\0\0"sv;

/// The content of a PNG file: its header and its filtered rows, still deflated.
struct PngContent {
  int rows = 0, cols = 0;
  std::string_view kind;
  size_t pixel_bytes = 0;
  std::string deflated;

  [[nodiscard]] size_t row_bytes() const { return pixel_bytes * static_cast<size_t>(cols); }
  /// With the number of the filter before each row.
  [[nodiscard]] size_t size() const { return (1 + row_bytes()) * static_cast<size_t>(rows); }
};

/// Reads the data of an IHDR chunk. Returns false if the image is of another kind, or absurdly large.
bool read_header(std::string_view data, PngContent& content) {
  constexpr size_t kHeaderBytes = 13;
  if (data.size() != kHeaderBytes) return false;
  content.kind = data.substr(8);
  if (content.kind == kGrey8) content.pixel_bytes = 1;
  if (content.kind == kGrey16) content.pixel_bytes = 2;
  if (content.kind == kRgb8) content.pixel_bytes = 3;
  if (content.kind == kRgba8) content.pixel_bytes = 4;
  const auto cols = big_endian_at<uint32_t>(data, 0), rows = big_endian_at<uint32_t>(data, 4);
  if (content.pixel_bytes == 0 || cols == 0 || rows == 0) return false;
  if (cols > kMaxPngSide_px || rows > kMaxPngSide_px) return false;
  content.cols = static_cast<int>(cols), content.rows = static_cast<int>(rows);
  return uint64_t{cols} * rows <= kMaxDecodedPixels;
}

/// Walks the chunks (PNG specification, section 5.3).
std::optional<PngContent> png_content(std::string_view bytes) {
  constexpr auto kSignature = "\x89PNG\r\n\x1a\n"sv;
  constexpr size_t kFrame = 12;  // a chunk adds length, type and checksum to its data
  if (!bytes.starts_with(kSignature)) return std::nullopt;
  PngContent content;
  for (size_t at = kSignature.size(); at + kFrame <= bytes.size();) {
    const auto length = big_endian_at<uint32_t>(bytes, at);
    if (length > bytes.size() - at - kFrame) return std::nullopt;
    const auto type = bytes.substr(at + 4, 4), data = bytes.substr(at + 8, length);
    if (libdeflate_crc32(0, type.data(), 4 + length) != big_endian_at<uint32_t>(bytes, at + 8 + length))
      return std::nullopt;
    const bool first = at == kSignature.size();
    if (first != (type == "IHDR")) return std::nullopt;
    if (first) {
      if (!read_header(data, content)) return std::nullopt;
    } else if (type == "IDAT") {
      content.deflated.append(data);
    } else if (type == "IEND") {
      return content.pixel_bytes == 0 ? std::nullopt : std::optional(std::move(content));
    }
    at += kFrame + length;
  }
  return std::nullopt;
}

/// Returns the filtered rows, with padding; null if they are damaged.
std::unique_ptr<uint8_t[]> inflate(const PngContent& content) {
  const size_t size = content.size();
  if (size > kMaxInflation * content.deflated.size()) return nullptr;
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(
      require_memory(libdeflate_alloc_decompressor()), libdeflate_free_decompressor);
  auto rows = std::make_unique_for_overwrite<uint8_t[]>(size + kPngRowPadding);
  std::fill_n(rows.get() + size, kPngRowPadding, uint8_t{0});
  size_t written = 0;
  const auto result = libdeflate_zlib_decompress(decompressor.get(), content.deflated.data(),
                                                 content.deflated.size(), rows.get(), size, &written);
  return result == LIBDEFLATE_SUCCESS && written == size ? std::move(rows) : nullptr;
}

/// Turns 16-bit numbers, high byte first, into those of the processor.
cv::Mat from_big_endian(const cv::Mat& byte_pairs) {
  cv::Mat image(byte_pairs.size(), CV_16UC1);
  for (int y = 0; y < image.rows; ++y) {
    auto* pixels = image.ptr<uint16_t>(y);
    std::memcpy(pixels, byte_pairs.ptr(y), sizeof(uint16_t) * static_cast<size_t>(image.cols));
    if constexpr (std::endian::native == std::endian::little) {
      for (int x = 0; x < image.cols; ++x) pixels[x] = static_cast<uint16_t>(pixels[x] << 8 | pixels[x] >> 8);
    }
  }
  return image;
}

}  // namespace

cv::Mat decode_common_png(std::string_view bytes) {
  const auto content = png_content(bytes);
  if (!content) return {};
  const auto rows = inflate(*content);
  if (!rows || !unfilter_png(rows.get(), static_cast<size_t>(content->rows), content->pixel_bytes,
                             content->row_bytes()))
    return {};
  const cv::Mat pixels(content->rows, content->cols, CV_8UC(static_cast<int>(content->pixel_bytes)),
                       rows.get() + 1, 1 + content->row_bytes());
  if (content->kind == kGrey16) return from_big_endian(pixels);
  if (content->kind == kGrey8) return pixels.clone();
  cv::Mat bgr;
  cv::cvtColor(pixels, bgr, content->kind == kRgb8 ? cv::COLOR_RGB2BGR : cv::COLOR_RGBA2BGR);
  return bgr;
}

cv::Mat decode_png(std::string_view bytes) {
  cv::Mat image = decode_common_png(bytes);
  return image.empty() ? decode_png_with_libpng(bytes) : image;
}

}  // namespace kinloop
