#include "kinloop/sensor/jpeg_codec.hpp"

#include <cstdint>
#include <memory>

#include <turbojpeg.h>

namespace kinloop {
namespace {

cv::Mat decode_jpeg_as(std::string_view bytes, int type, TJPF pixel_format) {
  const std::unique_ptr<void, decltype(&tjDestroy)> decoder(tjInitDecompress(), tjDestroy);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, color_space = 0;
  if (!decoder || tjDecompressHeader3(decoder.get(), data, bytes.size(), &width, &height, &subsampling,
                                      &color_space) != 0) {
    return {};
  }
  constexpr int64_t kMaxPixels = int64_t{1} << 28;  // more means a damaged header
  if (int64_t{width} * height > kMaxPixels) return {};
  cv::Mat image(height, width, type);
  const int result = tjDecompress2(decoder.get(), data, bytes.size(), image.data, width,
                                   static_cast<int>(image.step), height, pixel_format, 0);
  const bool failed = result != 0 && tjGetErrorCode(decoder.get()) != TJERR_WARNING;
  return failed ? cv::Mat() : image;
}

}  // namespace

cv::Mat decode_jpeg(std::string_view bytes) {
  return decode_jpeg_as(bytes, CV_8UC3, TJPF_BGR);
}

cv::Mat decode_jpeg_gray(std::string_view bytes) {
  return decode_jpeg_as(bytes, CV_8UC1, TJPF_GRAY);
}

}  // namespace kinloop
