#include "viewer/saved/sent_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <Eigen/Geometry>

#include "dense/surfels/voxel_samples.hpp"
#include "viewer/scene/incremental_cloud.hpp"

namespace kinloop {
namespace {

constexpr size_t kPiecePoints = 1 << 16;       // largest piece that a browser processes at once
constexpr size_t kFirstPiecePoints = 1 << 14;  // which a slow connection soon has: the first picture

/// A multiple of the box that holds nine tenths of the points per coordinate.
Eigen::AlignedBox3f outlier_fence(const ColoredCloud& mixed) {
  constexpr size_t kSample = 10000;
  constexpr float kTimes = 10;
  const size_t count = std::min(kSample, mixed.size());
  Eigen::AlignedBox3f box;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> values;
    for (size_t i = 0; i < count; ++i) values.push_back(mixed.points[i][axis]);
    std::sort(values.begin(), values.end());
    const float low = values[count / 20], high = values[count - 1 - count / 20];
    box.min()[axis] = low - kTimes * (high - low);
    box.max()[axis] = high + kTimes * (high - low);
  }
  return box;
}

void append_pieces(const ColoredCloud& cloud, std::vector<CloudPiece>& pieces) {
  for (size_t first = 0, next = 0; first < cloud.size(); first = next) {
    next = std::min(cloud.size(), first + (pieces.empty() ? kFirstPiecePoints : kPiecePoints));
    const auto begin = static_cast<long>(first), end = static_cast<long>(next);
    CloudPiece piece;
    piece.cloud.points.assign(cloud.points.begin() + begin, cloud.points.begin() + end);
    piece.cloud.colors.assign(cloud.colors.begin() + begin, cloud.colors.begin() + end);
    pieces.push_back(std::move(piece));
  }
}

double area_m2(const ColoredMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f ab = mesh.points[b] - mesh.points[a], ac = mesh.points[c] - mesh.points[a];
    area += 0.5 * ab.cross(ac).norm();
  }
  return area;
}

/// The number of the cell that holds each vertex, in the order of their first vertices.
std::vector<uint32_t> cells_of(const ColoredMesh& mesh, double edge_m) {
  std::unordered_map<VoxelKey, uint32_t> number_of;
  std::vector<uint32_t> cells;
  cells.reserve(mesh.points.size());
  for (const Eigen::Vector3f& point : mesh.points) {
    const Eigen::Vector3d corner = (point.cast<double>() / edge_m).array().floor();
    cells.push_back(number_of.try_emplace(voxel_key(corner), number_of.size()).first->second);
  }
  return cells;
}

/// The means of the vertices in each cell; without colours if the mesh has none.
ColoredMesh cell_means(const ColoredMesh& mesh, const std::vector<uint32_t>& cells) {
  const size_t count = cells.empty() ? 0 : *std::ranges::max_element(cells) + size_t{1};
  std::vector<Eigen::Vector4d> places(count, Eigen::Vector4d::Zero());
  std::vector<Eigen::Vector3d> colors(count, Eigen::Vector3d::Zero());
  for (size_t i = 0; i < cells.size(); ++i) {
    places[cells[i]] += mesh.points[i].homogeneous().cast<double>();
    if (mesh.colors.empty()) continue;
    const auto& [red, green, blue] = mesh.colors[i];
    colors[cells[i]] += Eigen::Vector3d(red, green, blue);
  }
  ColoredMesh means;
  for (size_t cell = 0; cell < count; ++cell) {
    means.points.emplace_back(places[cell].hnormalized().cast<float>());
    if (mesh.colors.empty()) continue;
    const Eigen::Vector3d color = colors[cell] / places[cell].w();
    means.colors.push_back(
        {static_cast<uint8_t>(color.x()), static_cast<uint8_t>(color.y()), static_cast<uint8_t>(color.z())});
  }
  return means;
}

ColoredMesh merged_by_cells(const ColoredMesh& mesh, double edge_m) {
  const std::vector<uint32_t> cells = cells_of(mesh, edge_m);
  ColoredMesh coarse = cell_means(mesh, cells);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Triangle corners = {cells[a], cells[b], cells[c]};
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
      coarse.triangles.push_back(corners);
  }
  return coarse;
}

}  // namespace

std::vector<CloudPiece> split_into_pieces(const ColoredCloud& cloud) {
  std::vector<CloudPiece> pieces;
  const ColoredCloud mixed = shuffled(cloud);
  if (mixed.size() == 0) return pieces;
  const Eigen::AlignedBox3f box = outlier_fence(mixed);
  ColoredCloud near, far;
  for (size_t i = 0; i < mixed.size(); ++i) {
    ColoredCloud& part = box.contains(mixed.points[i]) ? near : far;
    part.points.push_back(mixed.points[i]);
    part.colors.push_back(mixed.colors[i]);
  }
  append_pieces(near, pieces);
  append_pieces(far, pieces);
  return pieces;
}

ColoredMesh coarse_mesh(const ColoredMesh& mesh, size_t max_triangles) {
  constexpr double kCoarser = 1.2;
  if (mesh.triangles.size() <= max_triangles) return mesh;
  // A surface of this area has two triangles for each of its cells.
  double edge_m = std::sqrt(2 * area_m2(mesh) / static_cast<double>(std::max<size_t>(1, max_triangles)));
  if (!(edge_m > 0)) return {};
  ColoredMesh coarse = merged_by_cells(mesh, edge_m);
  while (coarse.triangles.size() > max_triangles) coarse = merged_by_cells(mesh, edge_m *= kCoarser);
  return coarse;
}

}  // namespace kinloop
