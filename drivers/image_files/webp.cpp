#include "drivers/image_files/webp.hpp"

#include <algorithm>
#include <cstdint>

#include "kinloop/sensor/images/image_limits.hpp"

#ifdef KINLOOP_WITH_WEBP
#include <webp/decode.h>
#endif

namespace kinloop {

bool is_webp(std::string_view bytes) {
  constexpr size_t kForm = 8;
  return bytes.starts_with("RIFF") && bytes.substr(std::min(kForm, bytes.size()), 4) == "WEBP";
}

#ifdef KINLOOP_WITH_WEBP

bool webp_available() {
  return true;
}

std::optional<cv::Size> webp_size(std::string_view bytes) {
  int width = 0, height = 0;
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
  if (WebPGetInfo(data, bytes.size(), &width, &height) == 0) return std::nullopt;
  return cv::Size(width, height);
}

cv::Mat decode_webp(std::string_view bytes) {
  const auto size = webp_size(bytes);
  if (!size || static_cast<uint64_t>(size->area()) > kMaxDecodedPixels) return {};
  cv::Mat image(*size, CV_8UC3);
  const size_t stride = image.step[0];
  const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
  const bool decoded =
      WebPDecodeBGRInto(data, bytes.size(), image.data, stride * static_cast<size_t>(image.rows),
                        static_cast<int>(stride)) != nullptr;
  return decoded ? image : cv::Mat();
}

#else

bool webp_available() {
  return false;
}

std::optional<cv::Size> webp_size(std::string_view) {
  return std::nullopt;
}

cv::Mat decode_webp(std::string_view) {
  return {};
}

#endif

}  // namespace kinloop
