#include "kinloop/sensor/surfaces/surface_mask.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"

namespace kinloop {

SurfaceGrid without_points(SurfaceGrid surfaces, const cv::Mat& marked) {
  require(marked.total() == surfaces.gradients.size(), "without_points: marks of another grid");
  for (size_t i = 0; i < surfaces.gradients.size(); ++i) {
    if (marked.data[i] == 0) continue;
    surfaces.inverse_depths_per_m[i] = 0;
    surfaces.gradients[i].setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  return surfaces;
}

double marked_share(const cv::Mat& marked) {
  return marked.empty() ? 0
                        : static_cast<double>(cv::countNonZero(marked)) / static_cast<double>(marked.total());
}

cv::Mat marked_in_either(const cv::Mat& a, const cv::Mat& b) {
  if (a.empty()) return b;
  return b.empty() ? a : cv::Mat(a | b);
}

Eigen::Vector2f nearest_point(const SurfaceCamera& camera, const Eigen::Vector2f& pixel) {
  return ((pixel.array() + 0.5F) / static_cast<float>(camera.spacing_px)).floor();
}

bool is_marked(const cv::Mat& marked, const SurfaceCamera& camera, const Eigen::Vector2f& pixel) {
  if (marked.empty()) return false;
  const Eigen::Vector2f point = nearest_point(camera, pixel);
  const int x = static_cast<int>(std::clamp(point.x(), 0.0F, static_cast<float>(marked.cols - 1)));
  const int y = static_cast<int>(std::clamp(point.y(), 0.0F, static_cast<float>(marked.rows - 1)));
  return marked.ptr<uint8_t>(y)[x] != 0;
}

cv::Mat unmarked_pixels(const SurfaceCamera& camera, const cv::Mat& marked, const cv::Size& size) {
  require(marked.total() == camera.pixels.size(), "unmarked_pixels: marks of another grid");
  cv::Mat unmarked(size, CV_8UC1, cv::Scalar(255));
  const int reach_px = camera.spacing_px + camera.spacing_px / 2;
  const cv::Rect image({0, 0}, size);
  for (size_t i = 0; i < camera.pixels.size(); ++i) {
    if (marked.data[i] == 0 || camera.pixels[i].x < 0) continue;
    const cv::Point corner = camera.pixels[i] - cv::Point(reach_px, reach_px);
    unmarked(cv::Rect(corner, cv::Size(2 * reach_px + 1, 2 * reach_px + 1)) & image) = 0;
  }
  return unmarked;
}

cv::Mat large_regions(const cv::Mat& marked, int min_points) {
  if (cv::countNonZero(marked) < min_points) return cv::Mat::zeros(marked.size(), CV_8UC1);
  cv::Mat large, labels, stats, centroids;
  cv::morphologyEx(marked, large, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8UC1));
  cv::connectedComponentsWithStats(large, labels, stats, centroids, 8, CV_32S);
  for (size_t i = 0; i < large.total(); ++i) {
    const int label = labels.ptr<int>()[i];
    if (label > 0 && stats.at<int>(label, cv::CC_STAT_AREA) < min_points) large.data[i] = 0;
  }
  return large;
}

}  // namespace kinloop
