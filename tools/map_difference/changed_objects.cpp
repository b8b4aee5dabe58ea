#include <algorithm>
#include <map>
#include <tuple>

#include <Eigen/Eigenvalues>

#include "kinloop/core/disjoint_sets.hpp"
#include "tools/map_difference/map_difference.hpp"

namespace kinloop {
namespace {

/// Smaller groups are mostly edges that two visits saw from different sides.
constexpr size_t kLeastVoxels = 12;

/// What the two views of one object may differ by: the other side of it is seen.
constexpr double kSizeRatio = 2, kSpreadRatio = 1.35, kSpread_m = 0.03, kColor = 50;

using VoxelCorner = std::tuple<int, int, int>;

VoxelCorner voxel_at(const Eigen::Vector3f& p_world) {
  const Eigen::Vector3i corner = (p_world / static_cast<float>(kGroupVoxel_m)).array().floor().cast<int>();
  return {corner.x(), corner.y(), corner.z()};
}

/// The voxels with changed points, numbered in order.
std::map<VoxelCorner, uint32_t> changed_voxels(const ColoredCloud& cloud,
                                               const std::vector<PointChange>& changes) {
  std::map<VoxelCorner, uint32_t> voxels;
  for (size_t i = 0; i < cloud.size(); ++i)
    if (changes[i] == PointChange::kChanged) voxels.try_emplace(voxel_at(cloud.points[i]), 0U);
  uint32_t count = 0;
  for (auto& [corner, number] : voxels) number = count++;
  return voxels;
}

void join_neighbours(const std::map<VoxelCorner, uint32_t>& voxels, DisjointSets& sets) {
  for (const auto& [corner, number] : voxels) {
    const auto [x, y, z] = corner;
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dz = -1; dz <= 1; ++dz) {
          const auto neighbour = voxels.find({x + dx, y + dy, z + dz});
          if (neighbour != voxels.end()) sets.join(number, neighbour->second);
        }
      }
    }
  }
}

/// Computes the figures of a group from its points.
void measure(const ColoredCloud& cloud, PointGroup& group) {
  const auto count = static_cast<double>(group.points.size());
  for (const uint32_t i : group.points) {
    group.center_m += cloud.points[i].cast<double>() / count;
    group.color += Eigen::Vector3d(cloud.colors[i][0], cloud.colors[i][1], cloud.colors[i][2]) / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const uint32_t i : group.points) {
    const Eigen::Vector3d d = cloud.points[i].cast<double>() - group.center_m;
    covariance += d * d.transpose() / count;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
  group.spread_m = axes.eigenvalues().cwiseMax(0).cwiseSqrt().reverse();
}

/// Returns how unlike two groups are, 0 = equal; nothing if they are not one object.
std::optional<double> difference(const PointGroup& a, const PointGroup& b) {
  const auto [less, more] = std::minmax(a.voxels, b.voxels);
  if (static_cast<double>(more) > kSizeRatio * static_cast<double>(less)) return std::nullopt;
  const Eigen::Array3d least = a.spread_m.cwiseMin(b.spread_m), most = a.spread_m.cwiseMax(b.spread_m);
  if ((most > kSpreadRatio * least + kSpread_m).any()) return std::nullopt;
  const double color = (a.color - b.color).norm();
  if (color > kColor) return std::nullopt;
  return (most - least).sum() / kSpread_m + color / kColor;
}

}  // namespace

std::vector<PointGroup> group_changed_points(const ColoredCloud& cloud,
                                             const std::vector<PointChange>& changes) {
  const auto voxels = changed_voxels(cloud, changes);
  DisjointSets sets(voxels.size());
  join_neighbours(voxels, sets);
  std::map<uint32_t, PointGroup> by_set;
  for (const auto& [corner, number] : voxels) ++by_set[sets.find(number)].voxels;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (changes[i] != PointChange::kChanged) continue;
    by_set[sets.find(voxels.at(voxel_at(cloud.points[i])))].points.push_back(static_cast<uint32_t>(i));
  }
  std::vector<PointGroup> groups;
  for (auto& [set, group] : by_set) {
    if (group.voxels < kLeastVoxels) continue;
    measure(cloud, group);
    groups.push_back(std::move(group));
  }
  std::ranges::stable_sort(groups, std::greater<>(), &PointGroup::voxels);
  return groups;
}

std::vector<MovedPair> find_moved(const std::vector<PointGroup>& before,
                                  const std::vector<PointGroup>& after) {
  std::vector<std::pair<double, MovedPair>> candidates;
  for (size_t i = 0; i < before.size(); ++i) {
    for (size_t k = 0; k < after.size(); ++k)
      if (const auto unlike = difference(before[i], after[k])) candidates.push_back({*unlike, {i, k}});
  }
  std::ranges::stable_sort(candidates, {}, &std::pair<double, MovedPair>::first);
  std::vector<MovedPair> moved;
  for (const auto& [unlike, pair] : candidates) {
    const auto is_taken = [&pair = pair](const MovedPair& other) {
      return other.before == pair.before || other.after == pair.after;
    };
    if (std::ranges::none_of(moved, is_taken)) moved.push_back(pair);
  }
  return moved;
}

}  // namespace kinloop
