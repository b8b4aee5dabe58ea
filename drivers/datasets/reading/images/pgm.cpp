#include "drivers/datasets/reading/images/pgm.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>

namespace kinloop {
namespace {

bool is_blank(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}

/// Reads the next number after blanks and comments, and moves `position` behind it.
std::optional<int> next_number(std::string_view bytes, size_t& position) {
  while (position < bytes.size() && (is_blank(bytes[position]) || bytes[position] == '#')) {
    if (bytes[position] != '#') {
      ++position;
      continue;
    }
    while (position < bytes.size() && bytes[position] != '\n') ++position;
  }
  int value = 0;
  const char* begin = bytes.data() + position;
  const auto [end, error] = std::from_chars(begin, bytes.data() + bytes.size(), value);
  if (error != std::errc() || value <= 0) return std::nullopt;
  position += static_cast<size_t>(end - begin);
  return value;
}

}  // namespace

std::optional<PgmHeader> parse_pgm_header(std::string_view bytes) {
  constexpr int kMax_px = 30'000, kMaxValue = 65'535;
  if (!bytes.starts_with("P5")) return std::nullopt;
  size_t position = 2;
  const auto width = next_number(bytes, position);
  const auto height = width ? next_number(bytes, position) : std::nullopt;
  const auto max_value = height ? next_number(bytes, position) : std::nullopt;
  if (!max_value || position >= bytes.size() || !is_blank(bytes[position])) return std::nullopt;
  if (*width > kMax_px || *height > kMax_px || *max_value > kMaxValue) return std::nullopt;
  return PgmHeader{*width, *height, *max_value, position + 1};
}

cv::Mat decode_pgm(std::string_view bytes) {
  constexpr int kMaxOfByte = 255;
  const auto header = parse_pgm_header(bytes);
  if (!header) return {};
  const size_t pixels = static_cast<size_t>(header->width) * static_cast<size_t>(header->height);
  const size_t pixel_size = header->max_value > kMaxOfByte ? 2 : 1;
  if ((bytes.size() - header->pixels_begin) / pixel_size < pixels) return {};
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data() + header->pixels_begin);
  cv::Mat image(header->height, header->width, pixel_size == 2 ? CV_16UC1 : CV_8UC1);
  if (pixel_size == 1) {
    std::copy_n(data, pixels, image.ptr<uint8_t>());
    return image;
  }
  auto* values = image.ptr<uint16_t>();
  for (size_t i = 0; i < pixels; ++i) values[i] = static_cast<uint16_t>(data[2 * i] << 8 | data[2 * i + 1]);
  return image;
}

}  // namespace kinloop
