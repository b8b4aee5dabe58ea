#include "drivers/image_files/netpbm.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>

#include <opencv2/imgproc.hpp>

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

bool is_netpbm(std::string_view bytes) {
  return bytes.starts_with("P5") || bytes.starts_with("P6");
}

std::optional<NetpbmHeader> parse_netpbm_header(std::string_view bytes) {
  constexpr int kMax_px = 30'000, kMaxValue = 65'535, kColors = 3;
  if (!is_netpbm(bytes)) return std::nullopt;
  size_t position = 2;
  const auto width = next_number(bytes, position);
  const auto height = width ? next_number(bytes, position) : std::nullopt;
  const auto max_value = height ? next_number(bytes, position) : std::nullopt;
  if (!max_value || position >= bytes.size() || !is_blank(bytes[position])) return std::nullopt;
  if (*width > kMax_px || *height > kMax_px || *max_value > kMaxValue) return std::nullopt;
  return NetpbmHeader{*width, *height, *max_value, bytes[1] == '6' ? kColors : 1, position + 1};
}

cv::Mat decode_netpbm(std::string_view bytes) {
  constexpr int kMaxOfByte = 255, kMaxOfTwo = 65'535;
  const auto header = parse_netpbm_header(bytes);
  if (!header) return {};
  const size_t values = static_cast<size_t>(header->width) * static_cast<size_t>(header->height) *
                        static_cast<size_t>(header->channels);
  const size_t value_size = header->max_value > kMaxOfByte ? 2 : 1;
  if ((bytes.size() - header->pixels_begin) / value_size < values) return {};
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data() + header->pixels_begin);
  cv::Mat image(header->height, header->width,
                CV_MAKETYPE(value_size == 2 ? CV_16U : CV_8U, header->channels));
  if (value_size == 1) {
    std::copy_n(data, values, image.ptr<uint8_t>());
  } else {
    auto* to = image.ptr<uint16_t>();
    for (size_t i = 0; i < values; ++i) to[i] = static_cast<uint16_t>(data[2 * i] << 8 | data[2 * i + 1]);
  }
  if (header->channels == 1) return image;
  cv::cvtColor(image, image, cv::COLOR_RGB2BGR);
  const int largest = value_size == 2 ? kMaxOfTwo : kMaxOfByte;
  if (header->max_value < largest)
    image.convertTo(image, -1, static_cast<double>(largest) / header->max_value);
  return image;
}

}  // namespace kinloop
