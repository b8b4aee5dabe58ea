#include "viewer/report/render_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

constexpr int kSupersampling = 2;        ///< drawn larger, then averaged, for smooth edges
constexpr double kOutlierShare = 0.002;  ///< of the points may lie outside the picture at either end
constexpr double kMarginShare = 0.02;    ///< of the width, left empty on each side
constexpr double kMaxHeightShare = 1.2;  ///< maximum height of the picture relative to its width

/// The cloud in picture axes: x right, y down, z away from the viewer, metres.
using ViewPoints = std::vector<Eigen::Vector3f>;

/// Indices of the drawable points below the cut.
std::vector<size_t> points_below(const ColoredCloud& cloud, const CloudPictureOptions& view) {
  const Eigen::Vector3f up = view.up.normalized().cast<float>();
  std::vector<size_t> kept;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f& p = cloud.points[i];
    if (is_drawable(p) && static_cast<double>(up.dot(p)) <= view.cut_above_m) kept.push_back(i);
  }
  return kept;
}

/// Rows: right, away and up, where `right` is the horizontal direction of largest extent.
Eigen::Matrix3d level_axes(const ColoredCloud& cloud, const std::vector<size_t>& kept,
                           const CloudPictureOptions& view) {
  const Eigen::Vector3d up = view.up.normalized();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const size_t i : kept) mean += cloud.points[i].cast<double>();
  mean /= static_cast<double>(kept.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const size_t i : kept) {
    Eigen::Vector3d d = cloud.points[i].cast<double>() - mean;
    d -= up * up.dot(d);
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  Eigen::Vector3d right = solver.eigenvectors().col(2);
  right = (right - up * up.dot(right)).normalized();
  Eigen::Vector3d away = up.cross(right);

  // Tall objects go to the back, where they occlude nothing.
  double lean = 0;
  for (const size_t i : kept) {
    const Eigen::Vector3d d = cloud.points[i].cast<double>() - mean;
    lean += away.dot(d) * up.dot(d);
  }
  if (lean < 0) {
    right = -right;
    away = -away;
  }
  Eigen::Matrix3d axes;
  axes << right.transpose(), away.transpose(), up.transpose();
  return axes;
}

ViewPoints to_view(const ColoredCloud& cloud, const std::vector<size_t>& kept,
                   const CloudPictureOptions& view) {
  const Eigen::Matrix3d axes = level_axes(cloud, kept, view);
  const double elevation_rad = view.elevation_deg * std::numbers::pi / 180;
  const double s = std::sin(elevation_rad), c = std::cos(elevation_rad);
  Eigen::Matrix3d tilt;  // level axes to picture axes
  tilt << 1, 0, 0, 0, -s, -c, 0, c, -s;
  const Eigen::Matrix3f R = (tilt * axes).cast<float>();
  ViewPoints points;
  points.reserve(kept.size());
  for (const size_t i : kept) points.emplace_back(R * cloud.points[i]);
  return points;
}

/// Range of nearly all values of one axis.
std::pair<double, double> inlier_range(const ViewPoints& points, int axis) {
  std::vector<float> values;
  for (const auto& p : points) values.push_back(p[axis]);
  return {quantile(values, kOutlierShare), quantile(values, 1 - kOutlierShare)};
}

struct Canvas {
  cv::Mat color;    // 8UC3, BGR
  cv::Mat depth_m;  // 32FC1, distance from the viewer; infinity = empty
};

/// Draws every point as a square of size `point_m` with a z-buffer.
Canvas splat(const ColoredCloud& cloud, const std::vector<size_t>& kept, const ViewPoints& points,
             const CloudPictureOptions& view) {
  const auto [left, right] = inlier_range(points, 0);
  const auto [top, bottom] = inlier_range(points, 1);
  const double shown_m = std::max({right - left, (bottom - top) / kMaxHeightShare, view.point_m});
  const int width = view.width_px * kSupersampling;
  const double scale = width * (1 - 2 * kMarginShare) / shown_m;  // px per metre
  const double margin = width * kMarginShare;
  const int height = std::max(1, static_cast<int>(std::lround((bottom - top) * scale + 2 * margin)));
  const double x0 = margin + (width - 2 * margin - (right - left) * scale) / 2 - left * scale;
  const double y0 = margin - top * scale;

  Canvas canvas{cv::Mat(height, width, CV_8UC3, cv::Scalar::all(0)),
                cv::Mat(height, width, CV_32FC1, cv::Scalar(std::numeric_limits<float>::infinity()))};
  // Slightly larger than the spacing of the points, so that surfaces have no gaps.
  constexpr double kOverlap = 1.3;
  const int half = std::max(1, static_cast<int>(std::ceil(kOverlap * view.point_m * scale / 2)));
  for (size_t k = 0; k < points.size(); ++k) {
    const auto& p = points[k];
    const double x = x0 + static_cast<double>(p.x()) * scale, y = y0 + static_cast<double>(p.y()) * scale;
    if (!(x >= 0 && y >= 0 && x < width && y < height)) continue;
    const Rgb& rgb = cloud.colors[kept[k]];
    const int col = static_cast<int>(x), row = static_cast<int>(y);
    const int first = std::max(0, col - half), end = std::min(width, col + half);
    for (int r = std::max(0, row - half); r < std::min(height, row + half); ++r) {
      auto* depths = canvas.depth_m.ptr<float>(r);
      auto* colors = canvas.color.ptr<cv::Vec3b>(r);
      for (int q = first; q < end; ++q) {
        if (p.z() >= depths[q]) continue;
        depths[q] = p.z();
        colors[q] = {rgb[2], rgb[1], rgb[0]};
      }
    }
  }
  return canvas;
}

/// Darkens the pixels of one row that lie behind their surroundings.
void shade_row(Canvas& canvas, int row) {
  constexpr int kReachPx = 3 * kSupersampling;
  constexpr float kStrengthPerM = 1.2F, kMaxStepM = 0.5F;
  const int last_row = canvas.depth_m.rows - 1, last_col = canvas.depth_m.cols - 1;
  const auto* here = canvas.depth_m.ptr<float>(row);
  // At the border the pixel is compared with itself: not behind.
  const auto* above = row >= kReachPx ? canvas.depth_m.ptr<float>(row - kReachPx) : here;
  const auto* below = row + kReachPx <= last_row ? canvas.depth_m.ptr<float>(row + kReachPx) : here;
  auto* colors = canvas.color.ptr<cv::Vec3b>(row);
  for (int col = 0; col <= last_col; ++col) {
    const float z = here[col];
    if (std::isinf(z)) continue;
    const auto step = [=](float other) { return std::clamp(z - other, 0.0F, kMaxStepM); };
    const float behind_m = step(here[col + kReachPx <= last_col ? col + kReachPx : col]) +
                           step(here[col >= kReachPx ? col - kReachPx : col]) + step(below[col]) +
                           step(above[col]);
    if (behind_m > 0) colors[col] *= static_cast<double>(std::exp(-kStrengthPerM * behind_m));
  }
}

/// Darkens pixels that lie behind their surroundings (Boucheny 2009, "eye-dome lighting"): shows shape
/// without normals.
void shade(Canvas& canvas) {
  parallel_for(static_cast<size_t>(canvas.depth_m.rows), hardware_threads(), [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) shade_row(canvas, static_cast<int>(row));
  });
}

/// The drawing at its final size, transparent where empty.
cv::Mat finish(const Canvas& canvas) {
  cv::Mat drawn = canvas.depth_m < std::numeric_limits<float>::infinity();
  cv::Mat color, alpha;
  const cv::Size size(canvas.color.cols / kSupersampling, std::max(1, canvas.color.rows / kSupersampling));
  cv::resize(canvas.color, color, size, 0, 0, cv::INTER_AREA);
  cv::resize(drawn, alpha, size, 0, 0, cv::INTER_AREA);
  cv::Mat picture(size, CV_8UC4);
  constexpr int kOpaque = 255;
  for (int row = 0; row < size.height; ++row) {
    for (int col = 0; col < size.width; ++col) {
      const int a = alpha.at<uint8_t>(row, col);
      const auto& bgr = color.at<cv::Vec3b>(row, col);
      // The average includes black background pixels; divide by alpha to recover the colour of the drawn
      // part.
      const auto whole = [&](int i) { return cv::saturate_cast<uint8_t>(a == 0 ? 0 : bgr[i] * kOpaque / a); };
      picture.at<cv::Vec4b>(row, col) = {whole(0), whole(1), whole(2), static_cast<uint8_t>(a)};
    }
  }
  return picture;
}

}  // namespace

cv::Mat render_cloud(const ColoredCloud& cloud, const CloudPictureOptions& view) {
  require(view.up.norm() > 0 && view.width_px > 0 && view.point_m > 0,
          "render_cloud: the view needs an up direction and a size");
  const auto kept = points_below(cloud, view);
  if (kept.empty()) return {};
  Canvas canvas = splat(cloud, kept, to_view(cloud, kept, view), view);
  shade(canvas);
  return finish(canvas);
}

}  // namespace kinloop
