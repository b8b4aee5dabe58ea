#include "dense/texture/atlas/atlas_layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unordered_map>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "kinloop/core/disjoint_sets.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// Numbers the charts in the order of their first triangles; returns how many there are.
uint32_t number_charts(const ColoredMesh& mesh, std::span<const uint32_t> view_of_triangle,
                       std::vector<uint32_t>& chart_of_triangle) {
  DisjointSets pieces(mesh.triangles.size());
  for (const TrianglePair& pair : adjacent_triangles(mesh)) {
    const uint32_t view = view_of_triangle[pair.first];
    if (view != kNoView && view == view_of_triangle[pair.second]) pieces.join(pair.first, pair.second);
  }
  uint32_t count = 0;
  chart_of_triangle.resize(mesh.triangles.size());
  for (uint32_t i = 0; i < chart_of_triangle.size(); ++i) {
    const uint32_t first = pieces.find(i);
    chart_of_triangle[i] = first == i ? count++ : chart_of_triangle[first];
  }
  return count;
}

/// A chart before it is scaled and placed.
struct Chart {
  std::vector<uint32_t> corners;  // indices into the corners of the layout
  Eigen::Array2f low, high;       // of its corners, pixels of the image
};

/// The corners of each chart, with their pixels in the image.
class ChartShapes {
 public:
  ChartShapes(const ColoredMesh& mesh, std::span<const uint32_t> view_of_triangle,
              std::span<const PosedImage> views, const PinholeCamera& camera, AtlasLayout& layout)
      : mesh_(mesh), views_(views), camera_(camera), layout_(layout) {
    charts_.resize(number_charts(mesh, view_of_triangle, layout.chart_of_triangle));
    layout.triangles.resize(mesh.triangles.size());
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) add_triangle(i, view_of_triangle[i]);
    for (Chart& chart : charts_) bound(chart);
  }

  [[nodiscard]] const std::vector<Chart>& charts() const { return charts_; }

 private:
  void add_triangle(uint32_t number, uint32_t view) {
    const uint32_t chart = layout_.chart_of_triangle[number];
    const auto unseen = view == kNoView ? flat(number) : std::array<Eigen::Vector2f, 3>{};
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t vertex = mesh_.triangles[number][k];
      const auto [found, is_new] = corner_of_.try_emplace((uint64_t{chart} << 32) | vertex,
                                                          static_cast<uint32_t>(layout_.corners_px.size()));
      layout_.triangles[number][k] = found->second;
      if (!is_new) continue;
      charts_[chart].corners.push_back(found->second);
      layout_.vertex_of_corner.push_back(vertex);
      layout_.corners_px.push_back(view == kNoView ? unseen[k] : pixel(vertex, view));
    }
  }

  /// The shape of a triangle in its plane, in pixels of a camera 2 m away.
  [[nodiscard]] std::array<Eigen::Vector2f, 3> flat(uint32_t number) const {
    constexpr double kDistanceM = 2;
    const auto& [a, b, c] = mesh_.triangles[number];
    const Eigen::Vector3f ab = mesh_.points[b] - mesh_.points[a], ac = mesh_.points[c] - mesh_.points[a];
    const float base = ab.norm(), height = base > 0 ? ab.cross(ac).norm() / base : 0,
                along = base > 0 ? ab.dot(ac) / base : 0;
    const auto px_per_m = static_cast<float>(camera_.fx / kDistanceM);
    return {Eigen::Vector2f(0, 0), Eigen::Vector2f(px_per_m * base, 0),
            Eigen::Vector2f(px_per_m * along, px_per_m * height)};
  }

  [[nodiscard]] Eigen::Vector2f pixel(uint32_t vertex, uint32_t view) const {
    const SE3 T_camera_world = views_[view].T_world_camera.inverse();
    return camera_.project(T_camera_world * mesh_.points[vertex].cast<double>()).cast<float>();
  }

  void bound(Chart& chart) const {
    chart.low = chart.high = layout_.corners_px[chart.corners.front()];
    for (const uint32_t corner : chart.corners) {
      chart.low = chart.low.min(layout_.corners_px[corner].array());
      chart.high = chart.high.max(layout_.corners_px[corner].array());
    }
    chart.low = chart.low.floor();  // at full scale, the pixels of the atlas are those of the image
  }

  const ColoredMesh& mesh_;
  std::span<const PosedImage> views_;
  const PinholeCamera& camera_;
  AtlasLayout& layout_;
  std::vector<Chart> charts_;
  std::unordered_map<uint64_t, uint32_t> corner_of_;  // by chart and vertex
};

std::vector<cv::Size> sizes_at(const std::vector<Chart>& charts, double scale) {
  std::vector<cv::Size> sizes;
  sizes.reserve(charts.size());
  for (const Chart& chart : charts) {
    const Eigen::Array2d extent = scale * (chart.high - chart.low).cast<double>();
    const auto side = [](double px) { return static_cast<int>(std::ceil(px)) + 1 + 2 * kAtlasMarginPx; };
    sizes.emplace_back(side(extent.x()), side(extent.y()));
  }
  return sizes;
}

/// Packs the charts into an atlas about as high as wide.
std::optional<PackedRectangles> pack(const std::vector<cv::Size>& sizes, int max_size_px, cv::Size& size) {
  constexpr double kPackedShare = 0.9;
  double area = 0;
  int widest = 1;
  for (const cv::Size& each : sizes)
    area += static_cast<double>(each.area()), widest = std::max(widest, each.width);
  const int width = std::max(widest, static_cast<int>(std::ceil(std::sqrt(area / kPackedShare))));
  auto packed = pack_rectangles(sizes, std::min(width, max_size_px));
  if (!packed || packed->height > max_size_px) return std::nullopt;
  size = {std::min(width, max_size_px), std::max(packed->height, 1)};
  return packed;
}

/// The largest scale at which all charts fit, to a few percent, and their places.
PackedRectangles pack_at_best_scale(const std::vector<Chart>& charts, int max_size_px, AtlasLayout& layout) {
  constexpr double kStep = 0.94, kLeastScale = 0.02;
  for (layout.scale = 1; layout.scale > kLeastScale; layout.scale *= kStep) {
    const auto sizes = sizes_at(charts, layout.scale);
    auto packed = pack(sizes, max_size_px, layout.size);
    if (!packed) continue;
    for (size_t i = 0; i < sizes.size(); ++i) layout.charts.emplace_back(packed->corners[i], sizes[i]);
    return std::move(*packed);
  }
  throw UsageError(fmt::format(
      "mesh.texture_px is {}: too small for {} pieces of images; raise it (--texture {}) or simplify the "
      "mesh further (--triangles N)",
      max_size_px, charts.size(), 2 * max_size_px));
}

}  // namespace

AtlasLayout lay_out_atlas(const ColoredMesh& mesh, std::span<const uint32_t> view_of_triangle,
                          std::span<const PosedImage> views, const PinholeCamera& camera, int max_size_px) {
  AtlasLayout layout;
  const ChartShapes shapes(mesh, view_of_triangle, views, camera, layout);
  const auto packed = pack_at_best_scale(shapes.charts(), max_size_px, layout);
  const auto scale = static_cast<float>(layout.scale);
  for (size_t i = 0; i < shapes.charts().size(); ++i) {
    const Chart& chart = shapes.charts()[i];
    const Eigen::Array2f origin(static_cast<float>(packed.corners[i].x + kAtlasMarginPx),
                                static_cast<float>(packed.corners[i].y + kAtlasMarginPx));
    for (const uint32_t corner : chart.corners) {
      auto& px = layout.corners_px[corner];
      px = origin + scale * (px.array() - chart.low);
    }
  }
  return layout;
}

}  // namespace kinloop
