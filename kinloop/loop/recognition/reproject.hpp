#pragma once
// In: a keypoint with depth. Out: where another view would see it.

#include <cstdint>
#include <optional>

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// A projected keypoint.
struct Reprojection {
  Eigen::Vector2d pixel;
  Eigen::Vector3d p_view, p_source;  ///< in the axes of both cameras, m

  /// Returns by how many pyramid levels the keypoint is seen higher than in the source.
  [[nodiscard]] double level_step(double scale_factor) const;
};

/// Projects keypoint `index` of `points` into another view; nullopt if it has no depth, is out of view or
/// nearer than `margin_px` to the border.
std::optional<Reprojection> reproject(const Features& points, uint32_t index, const SE3& T_view_points,
                                      const PinholeCamera& camera, double margin_px);

}  // namespace kinloop
