#include "session/input/measures/edge_sample.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "kinloop/sensor/surfaces/depth_borders.hpp"
#include "session/input/measures/small_images.hpp"

namespace kinloop {
namespace {

constexpr int kSide_px = 160;

cv::Size small_size(const cv::Size& size) {
  const double scale = std::min(1.0, static_cast<double>(kSide_px) / std::max(size.width, size.height));
  return {std::max(1, cvRound(scale * size.width)), std::max(1, cvRound(scale * size.height))};
}

/// The coarsest octave that is not smaller than `size`; making an image smaller costs more than all else.
cv::Mat coarse_gray(const Frame& frame, const cv::Size& size) {
  cv::Mat gray = gray_of(frame);
  for (const cv::Mat& octave : frame.octaves) {
    if (octave.cols >= size.width && octave.rows >= size.height) gray = octave;
  }
  return gray;
}

/// The gradient's magnitude relative to that of its surroundings, so that neither texture nor light decides
/// where edges are.
cv::Mat edge_contrast(const cv::Mat& gray, const cv::Size& size) {
  constexpr double kBlur_px = 0.7, kSobelSum = 8, kNoise = 1, kStrongest = 2;
  constexpr int kSurroundings_px = 13;
  cv::Mat small, dx, dy, gradient, mean;
  cv::resize(gray, small, size, 0, 0, cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  cv::GaussianBlur(small, small, {}, kBlur_px);
  cv::Sobel(small, dx, CV_32F, 1, 0, 3, 1 / kSobelSum);
  cv::Sobel(small, dy, CV_32F, 0, 1, 3, 1 / kSobelSum);
  cv::magnitude(dx, dy, gradient);
  cv::blur(gradient, mean, {kSurroundings_px, kSurroundings_px});
  cv::Mat contrast = (gradient - mean) / (mean + kNoise);
  return cv::min(contrast, kStrongest);
}

/// Marks the borders in a line of pixels. `step` is the distance of neighbours in memory.
void mark_borders(const float* depths_m, uchar* borders, int length, int step) {
  constexpr int kMaxShadow_px = 3;
  find_depth_borders(
      length, kMaxShadow_px, [&](int i) { return depths_m[i * step]; },
      [&](int i) { borders[i * step] = 1; });
}

std::vector<Eigen::Vector2f> borders_of(const cv::Mat& depth_m) {
  constexpr size_t kMost = 256;
  cv::Mat marked = cv::Mat::zeros(depth_m.size(), CV_8UC1);
  for (int y = 0; y < depth_m.rows; ++y)
    mark_borders(depth_m.ptr<float>(y), marked.ptr<uchar>(y), depth_m.cols, 1);
  for (int x = 0; x < depth_m.cols; ++x)
    mark_borders(depth_m.ptr<float>(0) + x, marked.ptr<uchar>(0) + x, depth_m.rows, depth_m.cols);
  std::vector<cv::Point> all;
  cv::findNonZero(marked, all);
  const Eigen::Vector2f middle(0.5F * static_cast<float>(depth_m.cols - 1),
                               0.5F * static_cast<float>(depth_m.rows - 1));
  std::vector<Eigen::Vector2f> borders;
  const size_t count = std::min(all.size(), kMost);
  for (size_t i = 0; i < count; ++i) {
    const cv::Point& at = all[i * all.size() / count];
    borders.push_back(Eigen::Vector2f(static_cast<float>(at.x), static_cast<float>(at.y)) - middle);
  }
  return borders;
}

}  // namespace

EdgeImages edge_images_of(const Frame& frame) {
  const cv::Size size = small_size(frame.depth_m.size());
  return {coarse_gray(frame, size), sampled_depth(frame.depth_m, size)};
}

EdgeSample make_edge_sample(const EdgeImages& images) {
  constexpr int kMargin = EdgeSample::kMargin_px;
  EdgeSample sample;
  sample.size = images.depth_m.size();
  cv::copyMakeBorder(edge_contrast(images.gray, sample.size), sample.edges, kMargin, kMargin, kMargin,
                     kMargin, cv::BORDER_CONSTANT, 0);
  sample.borders = borders_of(images.depth_m);
  return sample;
}

EdgeSample make_edge_sample(const Frame& frame) {
  return make_edge_sample(edge_images_of(frame));
}

}  // namespace kinloop
