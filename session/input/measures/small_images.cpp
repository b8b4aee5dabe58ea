#include "session/input/measures/small_images.hpp"

#include <vector>

namespace kinloop {

cv::Mat gray_of(const Frame& frame) {
  return frame.gray.empty() ? frame.color.gray() : frame.gray;
}

cv::Mat sampled_depth(const cv::Mat& depth_m, const cv::Size& size) {
  cv::Mat small(size, CV_32FC1);
  std::vector<int> columns(static_cast<size_t>(size.width));  // a division for each pixel would cost more
  for (int x = 0; x < size.width; ++x)
    columns[static_cast<size_t>(x)] = (2 * x + 1) * depth_m.cols / (2 * size.width);
  for (int y = 0; y < size.height; ++y) {
    const auto* from = depth_m.ptr<float>((2 * y + 1) * depth_m.rows / (2 * size.height));
    auto* to = small.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) to[x] = from[columns[static_cast<size_t>(x)]];
  }
  return small;
}

}  // namespace kinloop
