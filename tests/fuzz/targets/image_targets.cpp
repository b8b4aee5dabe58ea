#include <opencv2/core.hpp>

#include "drivers/image_files/image_file.hpp"
#include "drivers/images/encoded_image.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"

namespace kinloop::fuzz {
namespace {

/// Every pixel is read, so that the sanitizer sees rows that end too early.
double sum_of_pixels(const cv::Mat& image) {
  return image.empty() ? 0 : cv::sum(image)[0];
}

void read_image_bytes(std::string_view bytes) {
  accept([&] { static_cast<void>(sum_of_pixels(decode_color_image(std::string(bytes), "image").bgr())); });
  accept([&] { static_cast<void>(sum_of_pixels(decode_depth_image(std::string(bytes), "image", 5000))); });
  static_cast<void>(sum_of_pixels(decode_image(bytes)));
}

}  // namespace

void read_png_bytes(std::string_view bytes) {
  read_image_bytes(bytes);
}

void read_jpeg_bytes(std::string_view bytes) {
  read_image_bytes(bytes);
  static_cast<void>(sum_of_pixels(decode_jpeg_gray(bytes)));
}

}  // namespace kinloop::fuzz
