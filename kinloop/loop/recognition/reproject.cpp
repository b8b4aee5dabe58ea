#include "kinloop/loop/recognition/reproject.hpp"

#include <cmath>

namespace kinloop {

double Reprojection::level_step(double scale_factor) const {
  return std::log(p_source.z() / p_view.z()) / std::log(scale_factor);
}

std::optional<Reprojection> reproject(const Features& points, uint32_t index, const SE3& T_view_points,
                                      const PinholeCamera& camera, double margin_px) {
  const auto source_depth_m = static_cast<double>(points.depths_m[index]);
  if (!(source_depth_m > 0)) return std::nullopt;
  const Eigen::Vector3d p_source = camera.unproject(points.pixels[index].cast<double>(), source_depth_m);
  const Eigen::Vector3d p_view = T_view_points * p_source;
  if (!(p_view.z() > 0)) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(p_view);
  if (!camera.contains(pixel, margin_px)) return std::nullopt;
  return Reprojection{pixel, p_view, p_source};
}

}  // namespace kinloop
