#include "drivers/image_files/bmp.hpp"

#include <cstdint>
#include <cstring>

#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {
namespace {

/// What the headers say: BITMAPFILEHEADER of 14 bytes, then BITMAPINFOHEADER or a longer one.
struct BmpHeader {
  int width = 0, height = 0;
  bool top_down = false;
  int bits = 0;
  uint32_t compression = 0;
  size_t palette_begin = 0, pixels_begin = 0;
};

template <class Number>
Number number_at(std::string_view bytes, size_t at) {  // little-endian, as this machine
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof(Number));
  return value;
}

std::optional<BmpHeader> parse_header(std::string_view bytes) {
  constexpr size_t kPixels = 10, kInfo = 14, kWidth = 18, kHeight = 22, kBits = 28, kCompression = 30,
                   kEnd = 54;
  constexpr int kMax_px = 30'000;
  if (!is_bmp(bytes) || bytes.size() < kEnd) return std::nullopt;
  const auto width = number_at<int32_t>(bytes, kWidth), height = number_at<int32_t>(bytes, kHeight);
  if (width <= 0 || width > kMax_px || height == 0 || height > kMax_px || height < -kMax_px)
    return std::nullopt;
  BmpHeader header;
  header.width = width;
  header.height = height < 0 ? -height : height;
  header.top_down = height < 0;
  header.bits = number_at<uint16_t>(bytes, kBits);
  header.compression = number_at<uint32_t>(bytes, kCompression);
  header.palette_begin = kInfo + size_t{number_at<uint32_t>(bytes, kInfo)};
  header.pixels_begin = number_at<uint32_t>(bytes, kPixels);
  return header;
}

bool is_known(const BmpHeader& header) {
  constexpr uint32_t kNone = 0, kBitFields = 3;  // of 32 bits: blue, green, red and alpha, as all write them
  const bool plain =
      header.compression == kNone && (header.bits == 8 || header.bits == 24 || header.bits == 32);
  return plain || (header.compression == kBitFields && header.bits == 32);
}

}  // namespace

bool is_bmp(std::string_view bytes) {
  return bytes.starts_with("BM");
}

std::optional<cv::Size> bmp_size(std::string_view bytes) {
  const auto header = parse_header(bytes);
  return header ? std::optional(cv::Size(header->width, header->height)) : std::nullopt;
}

cv::Mat decode_bmp(std::string_view bytes) {
  constexpr size_t kBitsOfRow = 32, kPaletteEntry = 4;
  const auto header = parse_header(bytes);
  if (!header || !is_known(*header)) return {};
  const auto width = static_cast<size_t>(header->width), height = static_cast<size_t>(header->height),
             bits = static_cast<size_t>(header->bits);
  const size_t stride = (bits * width + kBitsOfRow - 1) / kBitsOfRow * 4, pixel = bits / 8;
  const size_t begin = header->pixels_begin;
  if (width * height > kMaxDecodedPixels || begin > bytes.size() || bytes.size() - begin < stride * height)
    return {};
  cv::Mat image(header->height, header->width, CV_8UC3);
  for (size_t y = 0; y < height; ++y) {
    const size_t row = header->top_down ? y : height - 1 - y;
    const char* from = bytes.data() + begin + row * stride;
    auto* to = image.ptr<uint8_t>(static_cast<int>(y));
    for (size_t x = 0; x < width; ++x, from += pixel, to += 3) {
      const char* color = from;
      if (pixel == 1) {
        const size_t entry = header->palette_begin + kPaletteEntry * static_cast<uint8_t>(*from);
        if (entry + kPaletteEntry > bytes.size()) return {};
        color = bytes.data() + entry;
      }
      std::memcpy(to, color, 3);
    }
  }
  return image;
}

}  // namespace kinloop
