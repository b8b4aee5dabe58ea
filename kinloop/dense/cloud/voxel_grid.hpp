#pragma once
// In: voxel samples of successive images. Out: their fusion per voxel.

#include <array>
#include <cstdint>
#include <vector>

#include "kinloop/dense/cloud/voxel_samples.hpp"

namespace kinloop {

/// Fused samples of one voxel. Sums are weighted by the information of depth.
struct Voxel {
  VoxelKey key = 0;
  float weight = 0;                                      ///< 1/m^2
  float pixels = 0;                                      ///< total pixels of its samples
  Eigen::Vector3f offset_sum = Eigen::Vector3f::Zero();  ///< from the voxel's corner, in voxels
  Eigen::Vector3f normal_sum = Eigen::Vector3f::Zero();
  float color_weight = 0;
  std::array<uint16_t, 3> color{};  ///< weighted mean, in 1/256 of an intensity
  uint16_t views = 0;               ///< images that saw it; saturates
  uint16_t last_view = 0;           ///< low bits of the number of the latest image
};

/// Hash map from voxel key to voxel: linear probing over indices into a plain vector.
class VoxelGrid {
 public:
  /// Adds a sample of image number `view`; the samples of an image must be added consecutively.
  void add(const VoxelSample& sample, uint32_t view);

  /// Returns the voxel, or null if it has no sample.
  [[nodiscard]] const Voxel* find(VoxelKey key) const;

  /// The voxels in order of first insertion.
  [[nodiscard]] const std::vector<Voxel>& voxels() const { return voxels_; }

  /// Removes all voxels with keys from `key` on.
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
