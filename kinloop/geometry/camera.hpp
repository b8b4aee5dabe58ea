#pragma once
// In: points in the camera frame (x right, y down, z forward, metres). Out: pixels (x right, y down, (0, 0)
// is the centre of the top left pixel), and back. "Undistorted" pixels are those of an ideal pinhole camera
// with the same fx, fy, cx, cy; keypoints are undistorted once, and all estimation uses undistorted pixels.

#include <optional>

#include <Eigen/Core>

#include "kinloop/geometry/lens.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Pinhole camera with the distortion of its lens.
struct PinholeCamera {
  int width = 0;                          // px
  int height = 0;                         // px
  double fx = 0, fy = 0, cx = 0, cy = 0;  // px
  LensDistortion lens;

  bool operator==(const PinholeCamera&) const = default;

  [[nodiscard]] bool has_distortion() const { return !lens.is_identity(); }

  /// Returns the undistorted pixel of a point with z > 0.
  [[nodiscard]] Eigen::Vector2d project(const Eigen::Vector3d& p_camera) const {
    return {fx * p_camera.x() / p_camera.z() + cx, fy * p_camera.y() / p_camera.z() + cy};
  }

  /// Returns the point at depth `depth_m` (z) on the ray of the undistorted pixel.
  [[nodiscard]] Eigen::Vector3d unproject(const Eigen::Vector2d& pixel, double depth_m) const {
    return {(pixel.x() - cx) / fx * depth_m, (pixel.y() - cy) / fy * depth_m, depth_m};
  }

  /// 2x3 Jacobian of `project`.
  [[nodiscard]] Eigen::Matrix<double, 2, 3> project_jacobian(const Eigen::Vector3d& p_camera) const;

  /// Returns the raw (distorted) pixel of an undistorted one.
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& undistorted) const;

  /// Returns the 2x2 Jacobian of `distort`.
  [[nodiscard]] Eigen::Matrix2d distort_jacobian(const Eigen::Vector2d& undistorted) const;

  /// Returns the undistorted pixel of a raw one. A raw pixel that the lens cannot produce gives the limit of
  /// its field of view.
  [[nodiscard]] Eigen::Vector2d undistort(const Eigen::Vector2d& raw) const;

  /// Returns whether the pixel lies inside the image, at least `margin_px` from its border.
  [[nodiscard]] bool contains(const Eigen::Vector2d& pixel, double margin_px = 0) const {
    return pixel.x() >= margin_px && pixel.y() >= margin_px && pixel.x() <= width - 1 - margin_px &&
           pixel.y() <= height - 1 - margin_px;
  }
};

/// Returns the undistorted pixel of a raw one; nullopt if that is outside the lens's field of view:
/// distorting the result would not lead back to `raw`.
std::optional<Eigen::Vector2d> undistort_in_view(const PinholeCamera& camera, const Eigen::Vector2d& raw);

}  // namespace kinloop
