#pragma once
// In: surface points and views. Out: for each point, how many views contradict it. Such points are people who
// passed by or flying pixels at depth edges. And of the points that carving left, which are remnants: of
// something that moved, few views saw through every point, and what surrounds a remnant was mostly carved
// away.

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "dense/surfels/surface_points.hpp"

namespace kinloop {

/// The free space that a view observed.
struct MeasuredFreeSpace {
  SE3 T_camera_world;
  Velocity velocity = {};
  double depth_stamp_difference_s = 0;  ///< PosedImage::depth_stamp_difference_s
  std::vector<uint16_t> nearest;        ///< see ImageSurfels
};

/// Adds to each point the number of views that contradict it, and tells which were seen through. For a point
/// that `options.min_observations` images observed, these are the views that measured free space at its place
/// (none if `options.carve` is off); for other points, all views with its place in sight: unoccluded, whether
/// depth is known or not. The points of a block must be adjacent.
void count_contradictions(std::span<SurfacePoint> points, std::span<const MeasuredFreeSpace> views,
                          const DenseCamera& camera, const DenseOptions& options, int threads);

/// Counts points of cells of 16 cm.
class CarvedCells {
 public:
  /// Adds a point (world, metres), or moves one that was added as left to those carved away.
  void add_left(const Eigen::Vector3f& p_world) { ++at(p_world).left; }
  void add_carved(const Eigen::Vector3f& p_world) { ++at(p_world).carved; }
  void carve(const Eigen::Vector3f& p_world);

  /// Computes for each cell how much more likely its points stand still than that they moved: the logarithm
  /// of the ratio of points left to points carved away, there and in the 26 cells around.
  void update_log_odds();

  /// Returns that of the cell of a point that was added.
  [[nodiscard]] float log_odds(const Eigen::Vector3f& p_world) const;

 private:
  struct Cell {
    uint32_t left = 0, carved = 0;
    float log_odds = 0;
  };
  using Key = std::array<int32_t, 3>;
  struct Hash {
    size_t operator()(const Key& key) const;
  };

  static Key key_of(const Eigen::Vector3f& p_world);
  Cell& at(const Eigen::Vector3f& p_world) { return cells_[key_of(p_world)]; }

  std::unordered_map<Key, Cell, Hash> cells_;
};

/// Returns for each of the points left whether it is a remnant: its `surplus`, the number of views that saw
/// it beyond those that contradict it, does not outweigh its surroundings. `cells` must hold the points
/// carved away; those of the remnants are added.
std::vector<uint8_t> find_remnants(std::span<const Eigen::Vector3f> points, std::span<const uint16_t> surplus,
                                   CarvedCells& cells);

}  // namespace kinloop
