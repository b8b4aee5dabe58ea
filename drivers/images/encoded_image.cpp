#include "drivers/images/encoded_image.hpp"

#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "drivers/datasets/reading/images/image_bytes.hpp"
#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

bool is_png(std::string_view bytes) {
  return bytes.starts_with('\x89');
}

/// Throws InputError unless the image is whole and of a possible size.
void require_decodable(std::string_view bytes) {
  if (bytes.empty()) throw InputError("a compressed image cannot be decoded: it is empty");
  if (const auto damage = image_damage(bytes); !damage.empty())
    throw InputError(
        fmt::format("a compressed image cannot be decoded: {}", damage.substr(0, damage.find(';'))));
  const auto size = size_in_header(bytes);
  if (!size) throw InputError("a compressed image cannot be decoded: its header claims no possible size");
  if (size->width <= 0 || size->height <= 0 || int64_t{size->width} * size->height > kMaxImagePixels)
    throw InputError(fmt::format("a compressed image claims {} x {} pixels", size->width, size->height));
}

std::string_view text_of(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Reads the nibbles of RVL: numbers of three bits each and a bit for "more follow".
class NibbleReader {
 public:
  explicit NibbleReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  uint32_t number() {
    constexpr unsigned kMaxShift = 30;
    uint32_t value = 0;
    for (unsigned shift = 0; shift <= kMaxShift; shift += 3) {
      const uint32_t nibble = next();
      value |= (nibble & 7U) << shift;
      if ((nibble & 8U) == 0) return value;
    }
    throw InputError("RVL depth is damaged");
  }

 private:
  /// Nibbles come from 32-bit little-endian words, highest first.
  uint32_t next() {
    constexpr unsigned kNibbles = 8;
    if (left_ == 0) {
      if (bytes_.size() < sizeof(word_)) throw InputError("RVL depth is truncated");
      word_ = 0;
      for (size_t i = 0; i < sizeof(word_); ++i) word_ |= uint32_t{bytes_[i]} << (8 * i);
      bytes_ = bytes_.subspan(sizeof(word_));
      left_ = kNibbles;
    }
    const uint32_t nibble = word_ >> 28U;
    word_ <<= 4U;
    --left_;
    return nibble;
  }

  std::span<const uint8_t> bytes_;
  uint32_t word_ = 0;
  unsigned left_ = 0;
};

}  // namespace

cv::Mat decode_embedded_image(std::span<const uint8_t> data) {
  const std::string_view bytes = text_of(data);
  require_decodable(bytes);
  cv::Mat image = decode_image(bytes);
  if (image.empty()) throw InputError("a compressed image cannot be decoded: it is damaged");
  return image;
}

ColorImage decode_embedded_color(std::span<const uint8_t> data) {
  const std::string_view bytes = text_of(data);
  require_decodable(bytes);
  if (const auto turned = turned_by_exif(bytes); !turned.empty())
    throw InputError(fmt::format("a colour image is not upright: {}", turned));
  if (!is_png(bytes)) {
    if (auto jpeg = ColorImage::from_jpeg(std::string(bytes))) return *std::move(jpeg);
  }
  cv::Mat image = decode_embedded_image(data);
  if (image.type() == CV_16UC3) image = with_8_bits(image);
  if (image.type() == CV_8UC1) cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
  if (image.type() != CV_8UC3) throw InputError("a compressed colour image does not have 8 bits per channel");
  return image;
}

cv::Mat without_impossible_depth(cv::Mat depth_m) {
  constexpr float kMost = std::numeric_limits<float>::max();
  for (int y = 0; y < depth_m.rows; ++y) {
    auto* row = depth_m.ptr<float>(y);
    for (int x = 0; x < depth_m.cols; ++x) row[x] = row[x] > 0 && row[x] <= kMost ? row[x] : 0;
  }
  return depth_m;
}

cv::Mat decode_rvl(std::span<const uint8_t> bytes, cv::Size size) {
  if (size.width <= 0 || size.height <= 0 || int64_t{size.width} * size.height > kMaxImagePixels)
    throw InputError(fmt::format("RVL depth claims {} x {} pixels", size.width, size.height));
  cv::Mat depth(size, CV_16UC1, cv::Scalar(0));
  NibbleReader reader(bytes);
  auto* pixel = depth.ptr<uint16_t>();
  auto left = static_cast<uint32_t>(size.area());
  uint32_t value = 0;  // wraps in damaged bytes
  while (left > 0) {
    const uint32_t zeros = reader.number();
    if (zeros > left) throw InputError("RVL depth is damaged");
    pixel += zeros, left -= zeros;
    if (left == 0) break;
    uint32_t others = reader.number();
    if (others > left || (zeros == 0 && others == 0)) throw InputError("RVL depth is damaged");
    for (left -= others; others > 0; --others) {
      const uint32_t zigzag = reader.number();  // small numbers of either sign
      value += (zigzag >> 1U) ^ (0U - (zigzag & 1U));
      *pixel++ = static_cast<uint16_t>(value);
    }
  }
  return depth;
}

}  // namespace kinloop
