#include "kinloop/sensor/surfaces/mask.hpp"

#include <opencv2/core.hpp>

namespace kinloop {

cv::Mat with_cause(const cv::Mat& causes, const cv::Mat& mask, IgnoreCause cause) {
  cv::Mat all = causes.empty() ? cv::Mat::zeros(mask.size(), CV_8UC1) : causes.clone();
  cv::bitwise_or(all, cv::Scalar(static_cast<double>(cause)), all, mask == 0);
  return all;
}

cv::Mat used_pixels(const cv::Mat& causes) {
  return causes.empty() ? causes : cv::Mat(causes == 0);
}

cv::Mat intersection_of_masks(const cv::Mat& a, const cv::Mat& b) {
  if (a.empty()) return b;
  return b.empty() ? a : cv::Mat(cv::min(a, b));
}

}  // namespace kinloop
