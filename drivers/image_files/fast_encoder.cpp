#include "drivers/image_files/fast_encoder.hpp"

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include <libdeflate.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

std::string big_endian(uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

/// A PNG chunk: length, name, data, checksum of name and data.
std::string chunk(std::string_view name, std::string_view data) {
  const std::string body = std::string(name) + std::string(data);
  return big_endian(static_cast<uint32_t>(data.size())) + body +
         big_endian(libdeflate_crc32(0, body.data(), body.size()));
}

/// Converts samples to PNG order: red before blue, 16 bits with the high byte first.
cv::Mat in_png_order(const cv::Mat& image) {
  cv::Mat ordered;
  if (image.type() == CV_8UC3) {
    cv::cvtColor(image, ordered, cv::COLOR_BGR2RGB);
  } else if (image.type() == CV_16UC1) {
    const cv::Mat bytes(image.rows, image.cols, CV_8UC2, image.data, image.step);
    const std::vector<int> swapped = {0, 1, 1, 0};
    ordered.create(bytes.size(), CV_8UC2);
    cv::mixChannels({bytes}, {ordered}, swapped);
  } else {
    ordered = image;
  }
  return ordered;
}

/// Applies the filter "sub" to each row (difference to the pixel on the left) and prepends its number.
std::vector<uint8_t> filtered(const cv::Mat& ordered) {
  constexpr uint8_t kSub = 1;
  const size_t pixel = ordered.elemSize(), row = pixel * static_cast<size_t>(ordered.cols);
  std::vector<uint8_t> bytes;
  bytes.reserve((row + 1) * static_cast<size_t>(ordered.rows));
  for (int y = 0; y < ordered.rows; ++y) {
    const uint8_t* in = ordered.ptr(y);
    bytes.push_back(kSub);
    bytes.insert(bytes.end(), in, in + pixel);
    const size_t begin = bytes.size();
    bytes.resize(begin + row - pixel);
    uint8_t* out = bytes.data() + begin - pixel;
    for (size_t i = pixel; i < row; ++i) out[i] = static_cast<uint8_t>(in[i] - in[i - pixel]);
  }
  return bytes;
}

std::string compressed(const std::vector<uint8_t>& bytes) {
  constexpr int kLightest = 1;
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      require_memory(libdeflate_alloc_compressor(kLightest)), &libdeflate_free_compressor);
  std::string zlib(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  zlib.resize(
      libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), zlib.data(), zlib.size()));
  return zlib;
}

}  // namespace

std::string encode_png(const cv::Mat& image) {
  const int type = image.type();
  require(!image.empty() && (type == CV_8UC1 || type == CV_8UC3 || type == CV_16UC1),
          "encode_png: expected 8UC1, 8UC3 or 16UC1");
  constexpr char kGrey = 0, kColor = 2;
  const char bits = type == CV_16UC1 ? 16 : 8;
  std::string header =
      big_endian(static_cast<uint32_t>(image.cols)) + big_endian(static_cast<uint32_t>(image.rows));
  header += {bits, type == CV_8UC3 ? kColor : kGrey, 0, 0, 0};
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) +
         chunk("IDAT", compressed(filtered(in_png_order(image)))) + chunk("IEND", "");
}

}  // namespace kinloop
