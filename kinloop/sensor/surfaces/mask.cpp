#include "kinloop/sensor/surfaces/mask.hpp"

#include <opencv2/core.hpp>

namespace kinloop {

cv::Mat intersection_of_masks(const cv::Mat& a, const cv::Mat& b) {
  if (a.empty()) return b;
  return b.empty() ? a : cv::Mat(cv::min(a, b));
}

}  // namespace kinloop
