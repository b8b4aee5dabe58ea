#include "dense/undistorted_images.hpp"

#include <opencv2/imgproc.hpp>

namespace kinloop {

cv::Mat undistortion_of(const PinholeCamera& camera) {
  if (!camera.has_distortion()) return {};
  cv::Mat raw_pixels(camera.height, camera.width, CV_32FC2);
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const Eigen::Vector2d raw = camera.distort(Eigen::Vector2d(col, row));
      raw_pixels.at<cv::Vec2f>(row, col) = {static_cast<float>(raw.x()), static_cast<float>(raw.y())};
    }
  }
  return raw_pixels;
}

cv::Mat undistorted(const cv::Mat& image, const cv::Mat& raw_pixels) {
  if (raw_pixels.empty()) return image;
  cv::Mat result;
  cv::remap(image, result, raw_pixels, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  return result;
}

}  // namespace kinloop
