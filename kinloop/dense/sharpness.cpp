#include "kinloop/dense/sharpness.hpp"

#include <opencv2/imgproc.hpp>

namespace kinloop {

float image_sharpness(const cv::Mat& color) {
  cv::Mat gray, laplacian;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cv::Laplacian(gray, laplacian, CV_32F);
  return static_cast<float>(cv::mean(laplacian.mul(laplacian))[0]) / 1000;
}

}  // namespace kinloop
