#include "kinloop/sensor/images/color_image.hpp"

#include <utility>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"

namespace kinloop {

ColorImage::ColorImage(cv::Mat bgr) : bgr_(std::move(bgr)) {
  require(bgr_.empty() || bgr_.type() == CV_8UC3, "ColorImage: expected pixels of type 8UC3, BGR");
}

std::optional<ColorImage> ColorImage::from_jpeg(std::string file) {
  ColorImage image;
  image.gray_ = decode_jpeg_gray(file);
  if (image.gray_.empty()) return std::nullopt;
  image.jpeg_ = std::make_shared<const std::string>(std::move(file));
  return image;
}

cv::Mat ColorImage::gray() const {
  if (jpeg_ || bgr_.empty()) return gray_;
  cv::Mat gray;
  cv::cvtColor(bgr_, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

cv::Mat ColorImage::bgr() const {
  return jpeg_ ? decode_jpeg(*jpeg_) : bgr_;
}

}  // namespace kinloop
