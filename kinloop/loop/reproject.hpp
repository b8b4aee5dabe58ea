#pragma once
// Projection of the keypoints of one view into another.

#include <optional>

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// A projected keypoint.
struct Reprojection {
  Eigen::Vector2d pixel;
  double depth_m = 0;
  double source_depth_m = 0;  ///< depth in the source view
};

/// Projects keypoint `index` of `points` into another view; nullopt if it has no depth, is out of view or
/// nearer than `margin_px` to the border.
inline std::optional<Reprojection> reproject(const Features& points, uint32_t index, const SE3& T_view_points,
                                             const PinholeCamera& camera, double margin_px) {
  const auto source_depth_m = static_cast<double>(points.depths_m[index]);
  if (!(source_depth_m > 0)) return std::nullopt;
  const Eigen::Vector3d p_view =
      T_view_points * camera.unproject(points.pixels[index].cast<double>(), source_depth_m);
  if (!(p_view.z() > 0)) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(p_view);
  if (!camera.contains(pixel, margin_px)) return std::nullopt;
  return Reprojection{pixel, p_view.z(), source_depth_m};
}

}  // namespace kinloop
