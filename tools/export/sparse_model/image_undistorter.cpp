#include "tools/export/sparse_model/image_undistorter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {
namespace {

/// Returns the pinhole camera whose image is the largest rectangle inside the undistorted border of the raw
/// image, at most twice as wide and high: the border of a fisheye image is far out.
PinholeCamera inner_pinhole(const PinholeCamera& raw) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  const double right = raw.width - 1, bottom = raw.height - 1;
  Eigen::Vector2d low(-kUnknown, -kUnknown), high(kUnknown, kUnknown);
  for (int row = 0; row < raw.height; ++row) {
    if (const auto pixel = undistort_in_view(raw, {0, row})) low.x() = std::max(low.x(), pixel->x());
    if (const auto pixel = undistort_in_view(raw, {right, row})) high.x() = std::min(high.x(), pixel->x());
  }
  for (int col = 0; col < raw.width; ++col) {
    if (const auto pixel = undistort_in_view(raw, {col, 0})) low.y() = std::max(low.y(), pixel->y());
    if (const auto pixel = undistort_in_view(raw, {col, bottom})) high.y() = std::min(high.y(), pixel->y());
  }
  constexpr double kRounding = 1e-6, kMaxGrowth = 2, kMaxShrinkage = 4;
  const Eigen::Array2d raw_size(raw.width, raw.height), margin = raw_size * (kMaxGrowth - 1) / 2;
  const bool known = low.allFinite() && high.allFinite();
  low = (low.array() - kRounding).ceil().max((-margin).ceil());
  high = (high.array() + kRounding).floor().min((raw_size - 1 + margin).floor());
  const Eigen::Array2d size = (high - low).array() + 1;
  if (!known || !(size >= raw_size / kMaxShrinkage).all())
    throw InputError("the lens distortion of the camera cannot be removed; check its calibration");
  PinholeCamera pinhole;
  pinhole.width = static_cast<int>(size.x());
  pinhole.height = static_cast<int>(size.y());
  pinhole.fx = raw.fx, pinhole.fy = raw.fy;
  pinhole.cx = raw.cx - low.x(), pinhole.cy = raw.cy - low.y();
  return pinhole;
}

}  // namespace

ImageUndistorter::ImageUndistorter(const DenseCamera& camera, double rolling_shutter_s)
    : camera_(camera), readout_s_(rolling_shutter_s), pinhole_(inner_pinhole(camera.color)) {}

Eigen::Vector2d ImageUndistorter::undistort(const Eigen::Vector2d& raw, const Velocity& velocity) const {
  const Eigen::Vector3d ray = camera_.color.unproject(camera_.color.undistort(raw), 1);
  return pinhole_.project(ray + time_of_row_s(raw.y()) * velocity.angular_rad_s.cross(ray));
}

Eigen::Vector2d ImageUndistorter::distort(const Eigen::Vector2d& undistorted,
                                          const Velocity& velocity) const {
  constexpr int kRounds = 3;  // the row changes by far less than the image during its readout
  const Eigen::Vector3d ray = pinhole_.unproject(undistorted, 1);
  Eigen::Vector2d raw = camera_.color.distort(camera_.color.project(ray));
  if (readout_s_ == 0) return raw;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Matrix3d turned =
        Eigen::Matrix3d::Identity() + time_of_row_s(raw.y()) * skew(velocity.angular_rad_s);
    raw = camera_.color.distort(camera_.color.project(turned.inverse() * ray));
  }
  return raw;
}

cv::Mat ImageUndistorter::raw_pixels(const Velocity& velocity) const {
  cv::Mat pixels(pinhole_.height, pinhole_.width, CV_32FC2);
  for (int row = 0; row < pixels.rows; ++row) {
    for (int col = 0; col < pixels.cols; ++col) {
      const Eigen::Vector2f raw = distort({col, row}, velocity).cast<float>();
      pixels.at<cv::Vec2f>(row, col) = {raw.x(), raw.y()};
    }
  }
  return pixels;
}

cv::Mat ImageUndistorter::color(const cv::Mat& raw, const cv::Mat& raw_pixels) const {
  cv::Mat result;
  cv::remap(raw, result, raw_pixels, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_REPLICATE);
  return result;
}

cv::Mat ImageUndistorter::depth(const cv::Mat& raw_m, const cv::Mat& raw_pixels) const {
  cv::Mat result = cv::Mat::zeros(pinhole_.height, pinhole_.width, CV_32FC1);
  for (int row = 0; row < result.rows; ++row) {
    for (int col = 0; col < result.cols; ++col) {
      const auto& at = raw_pixels.at<cv::Vec2f>(row, col);
      const auto raw_col = std::lround(at[0]), raw_row = std::lround(at[1]);
      if (raw_col < 0 || raw_row < 0 || raw_col >= raw_m.cols || raw_row >= raw_m.rows) continue;
      const float measured_m = raw_m.at<float>(static_cast<int>(raw_row), static_cast<int>(raw_col));
      if (!(measured_m > 0)) continue;
      const Eigen::Vector3d ray = pinhole_.unproject({col, row}, 1);
      const double inverse = camera_.correct_inverse_depth(1 / measured_m, ray.x(), ray.y());
      if (inverse > 0) result.at<float>(row, col) = static_cast<float>(1 / inverse);
    }
  }
  return result;
}

}  // namespace kinloop
