#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dense/texture/view_candidates.hpp"

namespace kinloop {
namespace {

/// A vertex in the image. Inverse depth, unlike depth, is linear in the pixel.
struct ProjectedVertex {
  float x_px = 0, y_px = 0;
  float inverse_depth = 0;  ///< 1/m; 0: not in front of the camera
};

using Corners = std::array<ProjectedVertex, 3>;

/// Twice the signed area of a triangle with corners a, b and the pixel (x, y).
float edge(const ProjectedVertex& a, const ProjectedVertex& b, float x, float y) {
  return (b.x_px - a.x_px) * (y - a.y_px) - (b.y_px - a.y_px) * (x - a.x_px);
}

/// Raises the inverse depths that the triangle covers to its own.
void draw(const Corners& corners, cv::Mat& inverse_depth) {
  const auto& [a, b, c] = corners;
  const float area = edge(a, b, c.x_px, c.y_px);
  if (area == 0) return;
  const auto [left, right] = std::minmax({a.x_px, b.x_px, c.x_px});
  const auto [top, bottom] = std::minmax({a.y_px, b.y_px, c.y_px});
  const auto first_col = static_cast<int>(std::ceil(std::max(left, 0.0F)));
  const auto last_col = static_cast<int>(std::min(right, static_cast<float>(inverse_depth.cols - 1)));
  const auto first_row = static_cast<int>(std::ceil(std::max(top, 0.0F)));
  const auto last_row = static_cast<int>(std::min(bottom, static_cast<float>(inverse_depth.rows - 1)));
  for (int row = first_row; row <= last_row; ++row) {
    auto* pixels = inverse_depth.ptr<float>(row);
    for (int col = first_col; col <= last_col; ++col) {
      const auto x = static_cast<float>(col), y = static_cast<float>(row);
      const float share_a = edge(b, c, x, y) / area, share_b = edge(c, a, x, y) / area;
      const float share_c = 1 - share_a - share_b;
      if (share_a < 0 || share_b < 0 || share_c < 0) continue;
      const float here = share_a * a.inverse_depth + share_b * b.inverse_depth + share_c * c.inverse_depth;
      pixels[col] = std::max(pixels[col], here);
    }
  }
}

}  // namespace

cv::Mat render_depth(const ColoredMesh& mesh, const SE3& T_camera_world, const PinholeCamera& camera) {
  constexpr double kNearestM = 0.05;
  const Eigen::Matrix3d R = T_camera_world.R();
  std::vector<ProjectedVertex> vertices(mesh.points.size());
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Eigen::Vector3d p = R * mesh.points[i].cast<double>() + T_camera_world.translation;
    if (p.z() < kNearestM) continue;
    const Eigen::Vector2f pixel = camera.project(p).cast<float>();
    vertices[i] = {pixel.x(), pixel.y(), static_cast<float>(1 / p.z())};
  }
  cv::Mat inverse_depth = cv::Mat::zeros(camera.height, camera.width, CV_32FC1);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Corners corners = {vertices[a], vertices[b], vertices[c]};
    const bool in_front = std::all_of(corners.begin(), corners.end(),
                                      [](const ProjectedVertex& v) { return v.inverse_depth > 0; });
    if (in_front) draw(corners, inverse_depth);
  }
  for (auto pixel = inverse_depth.begin<float>(); pixel != inverse_depth.end<float>(); ++pixel)
    *pixel = *pixel > 0 ? 1 / *pixel : std::numeric_limits<float>::infinity();
  return inverse_depth;
}

}  // namespace kinloop
