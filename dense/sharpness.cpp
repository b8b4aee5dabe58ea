#include "dense/sharpness.hpp"

#include <algorithm>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace kinloop {
namespace {

/// Differences between neighbours along the rows of an image (`step` (1, 0)) or along its columns.
cv::Mat differences(const cv::Mat& gray, const cv::Point& step) {
  const cv::Size size(gray.cols - step.x, gray.rows - step.y);
  cv::Mat result;
  cv::absdiff(gray(cv::Rect(step, size)), gray(cv::Rect(cv::Point(), size)), result);
  return result;
}

float fine_contrast_along(const cv::Mat& gray, const cv::Point& step) {
  constexpr int kWindowPx = 9;
  const cv::Size window(step.x > 0 ? kWindowPx : 1, step.y > 0 ? kWindowPx : 1);
  cv::Mat blurred;
  cv::blur(gray, blurred, window);
  const cv::Mat before = differences(gray, step), after = differences(blurred, step);
  const double all = cv::sum(before)[0];
  const cv::Mat lost = cv::max(before - after, 0);
  return all > 0 ? static_cast<float>(cv::sum(lost)[0] / all) : 0.0F;
}

}  // namespace

float image_sharpness(const cv::Mat& color) {
  cv::Mat gray, laplacian;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cv::Laplacian(gray, laplacian, CV_32F);
  return static_cast<float>(cv::mean(laplacian.mul(laplacian))[0]) / 1000;
}

float fine_contrast(const cv::Mat& color) {
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  gray.convertTo(gray, CV_32F);
  return std::min(fine_contrast_along(gray, {1, 0}), fine_contrast_along(gray, {0, 1}));
}

}  // namespace kinloop
