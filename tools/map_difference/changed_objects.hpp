#pragma once
// In: the points that changed between two visits. Out: the objects that they belong to.

#include "dense/cloud/colored_cloud.hpp"
#include "tools/map_difference/changed_points.hpp"

namespace kinloop {

/// Edge of the voxels in which changed points are grouped.
constexpr double kGroupVoxel_m = 0.05;

/// Points of one visit that changed and are connected.
struct PointGroup {
  std::vector<uint32_t> points;                        ///< indices into the cloud
  size_t voxels = 0;                                   ///< occupied, of kGroupVoxel_m
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();  ///< mean of the points, world
  Eigen::Vector3d spread_m = Eigen::Vector3d::Zero();  ///< standard deviations along its axes, largest first
  Eigen::Vector3d color = Eigen::Vector3d::Zero();     ///< mean red, green, blue, 0 to 255

  /// Returns about the size of the surface.
  [[nodiscard]] double surface_m2() const {
    return static_cast<double>(voxels) * (kGroupVoxel_m * kGroupVoxel_m);
  }
};

/// Returns the groups of at least some 300 cm^2, the largest first.
std::vector<PointGroup> group_changed_points(const ColoredCloud& cloud,
                                             const std::vector<PointChange>& changes);

/// A group before and one after that look like the same object.
struct MovedPair {
  size_t before = 0, after = 0;  ///< indices into the groups
};

/// Pairs groups of similar size, shape and colour, each at most once, the most alike first.
std::vector<MovedPair> find_moved(const std::vector<PointGroup>& before,
                                  const std::vector<PointGroup>& after);

}  // namespace kinloop
