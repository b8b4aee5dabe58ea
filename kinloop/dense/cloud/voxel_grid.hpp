#pragma once
// In: samples of voxels, image after image. Out: what all images together say about each voxel.

#include <array>
#include <cstdint>
#include <vector>

#include "kinloop/dense/cloud/voxel_samples.hpp"

namespace kinloop {

/// What all images said about one voxel. Sums are weighted by how sure depth is there.
struct Voxel {
  VoxelKey key = 0;
  float weight = 0;                                      ///< 1/m^2
  float pixels = 0;                                      ///< all that fell into it
  Eigen::Vector3f offset_sum = Eigen::Vector3f::Zero();  ///< from the voxel's corner, voxels
  Eigen::Vector3f normal_sum = Eigen::Vector3f::Zero();
  float color_weight = 0;
  std::array<uint16_t, 3> color{};  ///< weighted mean, 1/256 of a intensity
  uint16_t views = 0;               ///< images that saw it; stays at the most it can hold
  uint16_t last_view = 0;           ///< low bits of the latest one's number
};

/// Voxels found by key: a table of indices with linear probing over a plain list.
class VoxelGrid {
 public:
  /// Adds a sample of image number `view`; images come one after the other, each with a number of its own.
  void add(const VoxelSample& sample, uint32_t view);

  /// The voxel, or null where nothing was seen.
  [[nodiscard]] const Voxel* find(VoxelKey key) const;

  /// The voxels in the order in which they were first seen.
  [[nodiscard]] const std::vector<Voxel>& voxels() const { return voxels_; }

  /// Forgets all voxels from `key` on.
  void erase_from(VoxelKey key);

 private:
  Voxel& find_or_insert(VoxelKey key);
  [[nodiscard]] size_t slot_of(VoxelKey key) const;
  void rebuild_table(size_t size);

  std::vector<uint32_t> table_;  // index into voxels_ plus one; 0 = free
  std::vector<Voxel> voxels_;
};

/// Mean position of a voxel's points, metres.
Eigen::Vector3f mean_point(const Voxel& voxel, double voxel_m);

/// Mean colour of a voxel's points.
Rgb mean_color(const Voxel& voxel);

}  // namespace kinloop
