#include "apps/run/cloud_quality.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "kinloop/core/quantile.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/dense/cloud/voxel_samples.hpp"

namespace kinloop {
namespace {

constexpr double kNearM = 0.01;

Eigen::Vector3i cell_of(const Eigen::Vector3d& p) {
  return (p / kNearM).array().floor().cast<int>();
}

uint64_t key_of(const Eigen::Vector3i& cell) {
  constexpr int64_t kOffset = 1 << 20;
  const auto part = [&](int axis) { return static_cast<uint64_t>(cell(axis) + kOffset); };
  return part(0) | part(1) << 21 | part(2) << 42;
}

/// Points by grid cell.
using Cells = std::unordered_map<uint64_t, std::vector<Eigen::Vector3d>>;

bool has_near(const Cells& cells, const Eigen::Vector3d& p) {
  const Eigen::Vector3i home = cell_of(p);
  for (int k = 0; k < 27; ++k) {
    const auto found = cells.find(key_of(home + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
    if (found == cells.end()) continue;
    for (const Eigen::Vector3d& other : found->second) {
      if ((other - p).norm() <= kNearM) return true;
    }
  }
  return false;
}

/// One point per cell of the visible surface.
std::vector<Eigen::Vector3d> visible_surface(const SimulatedSource& room) {
  constexpr size_t kEvery = 10;
  constexpr float kMinM = 0.5F, kMaxM = 4;
  const RayTable rays = ray_table(room.camera().color);
  std::unordered_set<uint64_t> seen;
  std::vector<Eigen::Vector3d> points;
  for (size_t f = 0; f < room.info().frames; f += kEvery) {
    const cv::Mat depth_m = room.frame(f).depth_m;
    const SE3& T_world_camera = room.info().ground_truth[f].T_world_camera;
    for (int i = 0; i < static_cast<int>(depth_m.total()); ++i) {
      const float z = depth_m.at<float>(i / depth_m.cols, i % depth_m.cols);
      if (!(z >= kMinM && z <= kMaxM)) continue;
      const Eigen::Vector2f& ray = rays.rays[static_cast<size_t>(i)];
      const Eigen::Vector3f p_camera(ray.x() * z, ray.y() * z, z);
      const Eigen::Vector3d p = T_world_camera * p_camera.cast<double>();
      if (seen.insert(key_of(cell_of(p))).second) points.push_back(p);
    }
  }
  return points;
}

}  // namespace

CloudQuality cloud_quality(const ColoredCloud& cloud, const SimulatedSource& room, const SE3& T_truth_map) {
  constexpr size_t kMaxJudged =
      100'000;  // limit, since the distance to a surface is searched among all of the room's
  const size_t step = cloud.size() / kMaxJudged + 1;
  std::vector<double> distances_m((cloud.size() + step - 1) / step);
  parallel_for(distances_m.size(), hardware_threads(), [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      distances_m[i] = room.distance_to_surface(T_truth_map * cloud.points[i * step].cast<double>());
    }
  });
  Cells cells;
  for (const Eigen::Vector3f& point : cloud.points) {
    const Eigen::Vector3d p = T_truth_map * point.cast<double>();
    cells[key_of(cell_of(p))].push_back(p);
  }
  const auto surface = visible_surface(room);
  const auto covered = std::count_if(surface.begin(), surface.end(),
                                     [&](const Eigen::Vector3d& p) { return has_near(cells, p); });
  CloudQuality quality;
  quality.points = cloud.size();
  quality.accuracy_median_m = quantile(distances_m, 0.5);
  quality.accuracy_p95_m = quantile(distances_m, 0.95);
  quality.completeness =
      surface.empty() ? 0 : static_cast<double>(covered) / static_cast<double>(surface.size());
  return quality;
}

}  // namespace kinloop
