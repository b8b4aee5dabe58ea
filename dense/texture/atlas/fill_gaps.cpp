#include "dense/texture/atlas/fill_gaps.hpp"

#include <algorithm>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace kinloop {

void fill_gaps(cv::Mat& image, const cv::Mat& painted) {
  const double share = cv::mean(painted)[0];
  if (share == 0 || std::min(image.cols, image.rows) <= 1) return;
  image.setTo(cv::Scalar::all(0), painted == 0);
  const cv::Size half((image.cols + 1) / 2, (image.rows + 1) / 2);
  cv::Mat small, weight;
  cv::resize(image, small, half, 0, 0, cv::INTER_AREA);
  cv::resize(painted, weight, half, 0, 0, cv::INTER_AREA);
  for (int row = 0; row < half.height; ++row) {
    for (int col = 0; col < half.width; ++col) {
      const int w = weight.at<uint8_t>(row, col);
      if (w == 0) continue;
      for (int k = 0; k < 3; ++k) {
        auto& value = small.at<cv::Vec3b>(row, col)[k];
        value = cv::saturate_cast<uint8_t>(value * 255 / w);
      }
    }
  }
  const cv::Mat known = weight > 0;
  fill_gaps(small, known);
  cv::Mat filling;
  cv::resize(small, filling, image.size(), 0, 0, cv::INTER_LINEAR);
  filling.copyTo(image, painted == 0);
}

}  // namespace kinloop
