#include "apps/reproduce/trajectory_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace kinloop {
namespace {

constexpr double kPictureWidth = 720, kPictureHeight = 480, kPictureMargin = 40;

Eigen::AlignedBox3d extent_of(const std::vector<DrawnPath>& paths) {
  Eigen::AlignedBox3d box;
  for (const DrawnPath& drawn : paths) {
    for (const auto& pose : drawn.path) box.extend(pose.T_world_camera.translation);
  }
  return box;
}

/// The axes of the two largest extents, the larger first.
std::array<int, 2> drawn_axes(const Eigen::AlignedBox3d& box) {
  std::array<int, 3> axes{0, 1, 2};
  const Eigen::Vector3d size = box.sizes();
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return size[a] > size[b]; });
  return {axes[0], axes[1]};
}

std::string points_of(const Trajectory& path, const std::array<int, 2>& axes, const Eigen::Vector3d& low,
                      double scale) {
  std::string points;
  for (const auto& pose : path) {
    const Eigen::Vector3d p = scale * (pose.T_world_camera.translation - low);
    points += fmt::format("{:.1f},{:.1f} ", kPictureMargin + p[axes[0]], kPictureMargin + p[axes[1]]);
  }
  return points;
}

}  // namespace

std::string trajectory_picture(const std::vector<DrawnPath>& paths) {
  const Eigen::AlignedBox3d box = extent_of(paths);
  const auto axes = drawn_axes(box);
  const Eigen::Vector3d size = box.sizes().cwiseMax(0.01);
  const double scale = std::min((kPictureWidth - 2 * kPictureMargin) / size[axes[0]],
                                (kPictureHeight - 3 * kPictureMargin) / size[axes[1]]);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" "
      "font-size=\"15\"><rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
      kPictureWidth, kPictureHeight);
  double name_x = kPictureMargin;
  for (const DrawnPath& drawn : paths) {
    svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n",
                       points_of(drawn.path, axes, box.min(), scale), drawn.color);
    svg += fmt::format("<text x=\"{}\" y=\"{}\" fill=\"{}\">{}</text>\n", name_x, kPictureHeight - 12,
                       drawn.color, drawn.name);
    name_x += 40 + 8.5 * static_cast<double>(drawn.name.size());
  }
  const double bar_m = std::pow(10.0, std::floor(std::log10(size[axes[0]])));
  svg += fmt::format(
      "<path d=\"M{0:.1f} {2}H{1:.1f}\" stroke=\"#333\" stroke-width=\"3\"/><text x=\"{0:.1f}\" y=\"{3}\" "
      "fill=\"#333\">{4} m</text>\n",
      kPictureWidth - kPictureMargin - scale * bar_m, kPictureWidth - kPictureMargin, kPictureHeight - 34,
      kPictureHeight - 12, bar_m);
  return svg + "</svg>\n";
}

}  // namespace kinloop
