#include "kinloop/sensor/camera/registration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <opencv2/core.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {
namespace {

/// Neighbours whose depths differ by more than this share belong to different objects. On a wall seen at 80
/// degrees depth changes by 1 % per pixel, at an edge by much more.
constexpr float kJumpShare = 0.03F;

/// A point with a barycentric coordinate below this is outside; slightly below 0, so that rounding leaves no
/// gap between neighbours.
constexpr float kOutside = -1e-3F;

/// The distance of neighbours in the colour image should scale with the ratio of the focal lengths. If it is
/// this many times larger, the distortion polynomial has folded over.
constexpr double kMaxStretch = 8;

/// Twice the signed area of the triangle.
float edge(const cv::Point2f& a, const cv::Point2f& b, const cv::Point2f& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// The ray of a raw pixel at z = 1; NaN for a pixel outside the lens's field of view, whose depth has no
/// meaning.
Eigen::Vector2f ray_of(const PinholeCamera& camera, const Eigen::Vector2d& raw) {
  const auto undistorted = undistort_in_view(camera, raw);
  if (!undistorted) return Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
  return camera.unproject(*undistorted, 1).head<2>().cast<float>();
}

}  // namespace

DepthRegistration::DepthRegistration(const RgbdCamera& camera)
    : color_(camera.color),
      R_color_depth_(camera.T_color_depth.R().cast<float>()),
      t_color_depth_(camera.T_color_depth.translation.cast<float>()) {
  require(camera.depth.has_value(), "DepthRegistration: the camera's depth is already registered");
  depth_ = *camera.depth;
  longest_side_px_ = static_cast<float>(kMaxStretch * std::max(1.0, color_.fx / depth_.fx));
  rays_.reserve(static_cast<size_t>(depth_.width) * static_cast<size_t>(depth_.height));
  for (int y = 0; y < depth_.height; ++y) {
    for (int x = 0; x < depth_.width; ++x) {
      rays_.emplace_back(ray_of(depth_, Eigen::Vector2d(x, y)));
    }
  }
}

DepthRegistration::Vertex DepthRegistration::vertex(const Eigen::Vector2f& ray, float depth_m) const {
  constexpr double kMargin = 0.25;  // of the image size; farther out the distortion polynomial is meaningless
  constexpr float kMinDepthM = 1e-3F;
  if (!(depth_m > 0)) return {};
  const Eigen::Vector3f p = depth_m * (R_color_depth_ * ray.homogeneous()) + t_color_depth_;
  if (!(p.z() >= kMinDepthM)) return {};  // also without a ray
  const Eigen::Vector2d undistorted = color_.project(p.cast<double>());
  const double margin_x = kMargin * color_.width, margin_y = kMargin * color_.height;
  const bool near_image = undistorted.x() > -margin_x && undistorted.x() < color_.width + margin_x &&
                          undistorted.y() > -margin_y && undistorted.y() < color_.height + margin_y;
  if (!near_image) return {};
  const Eigen::Vector2f pixel = color_.distort(undistorted).cast<float>();
  return {pixel.x(), pixel.y(), 1 / p.z(), depth_m};
}

void DepthRegistration::draw(cv::Mat& image, const Vertex& a, const Vertex& b, const Vertex& c) const {
  const cv::Point2f at_a(a.x, a.y), at_b(b.x, b.y), at_c(c.x, c.y);
  const float area = edge(at_a, at_b, at_c);
  const auto [least_x, most_x] = std::minmax({a.x, b.x, c.x});
  const auto [least_y, most_y] = std::minmax({a.y, b.y, c.y});
  if (area == 0 || std::max(most_x - least_x, most_y - least_y) > longest_side_px_) return;
  const int left = std::max(0, static_cast<int>(std::ceil(least_x)));
  const int right = std::min(image.cols - 1, static_cast<int>(std::floor(most_x)));
  const int top = std::max(0, static_cast<int>(std::ceil(least_y)));
  const int bottom = std::min(image.rows - 1, static_cast<int>(std::floor(most_y)));
  for (int y = top; y <= bottom; ++y) {
    auto* row = image.ptr<float>(y);
    for (int x = left; x <= right; ++x) {
      const cv::Point2f p(static_cast<float>(x), static_cast<float>(y));
      const float share_a = edge(at_b, at_c, p) / area;
      const float share_b = edge(at_c, at_a, p) / area;
      const float share_c = 1 - share_a - share_b;
      if (share_a < kOutside || share_b < kOutside || share_c < kOutside) continue;
      // The inverse depth of a plane is linear in the image.
      const float depth_m =
          1 / (share_a * a.inverse_depth + share_b * b.inverse_depth + share_c * c.inverse_depth);
      if (row[x] == 0 || depth_m < row[x]) row[x] = depth_m;
    }
  }
}

cv::Mat DepthRegistration::operator()(const cv::Mat& depth_m) const {
  require(depth_m.type() == CV_32FC1 && depth_m.cols == depth_.width && depth_m.rows == depth_.height,
          "DepthRegistration: expected depth of the depth camera's size");
  const auto width = static_cast<size_t>(depth_.width);
  const auto vertices_of = [&](int y) {
    std::vector<Vertex> row(width);
    const auto* depths = depth_m.ptr<float>(y);
    for (size_t x = 0; x < width; ++x) row[x] = vertex(rays_[static_cast<size_t>(y) * width + x], depths[x]);
    return row;
  };
  const auto joined = [](const std::array<const Vertex*, 3>& corners) {
    const auto [least, most] = std::minmax({corners[0]->depth_m, corners[1]->depth_m, corners[2]->depth_m});
    return least > 0 && most - least <= kJumpShare * least;
  };
  cv::Mat registered(color_.height, color_.width, CV_32FC1, cv::Scalar(0));
  std::vector<Vertex> above = vertices_of(0);
  for (int y = 1; y < depth_.height; ++y) {
    std::vector<Vertex> below = vertices_of(y);
    for (size_t x = 1; x < width; ++x) {
      const Vertex &a = above[x - 1], &b = above[x], &c = below[x - 1], &d = below[x];
      if (joined({&a, &b, &c})) draw(registered, a, b, c);
      if (joined({&b, &c, &d})) draw(registered, b, c, d);
    }
    above = std::move(below);
  }
  return registered;
}

cv::Mat DepthPreparation::operator()(cv::Mat depth_m) {
  if (camera_.depth_shift_m != 0) {
    cv::add(depth_m, camera_.depth_shift_m, depth_m, depth_m > 0);
    depth_m.setTo(0, depth_m < 0);
  }
  if (!camera_.depth) return depth_m;
  if (!registration_) registration_.emplace(camera_);
  return (*registration_)(depth_m);
}

RgbdCamera registered(RgbdCamera camera) {
  constexpr double kTumUnits = 5000;
  camera.depth.reset();
  camera.T_color_depth = {};
  camera.depth_shift_m = 0;
  camera.depth_scale = kTumUnits;
  return camera;
}

PinholeCamera resized(const PinholeCamera& camera, int width) {
  const double scale = static_cast<double>(width) / camera.width;
  PinholeCamera small = camera;
  small.width = width;
  small.height = static_cast<int>(std::lround(camera.height * scale));
  small.fx *= scale;
  small.fy *= scale;
  // Pixel centres are integers: an image begins half a pixel before its first centre.
  small.cx = (camera.cx + 0.5) * scale - 0.5;
  small.cy = (camera.cy + 0.5) * scale - 0.5;
  return small;
}

}  // namespace kinloop
