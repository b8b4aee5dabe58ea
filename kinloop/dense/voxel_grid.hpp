#pragma once
// In: samples of voxels, image after image. Out: one mean point and colour per voxel.

#include <array>
#include <cstdint>
#include <vector>

#include "kinloop/dense/colored_cloud.hpp"
#include "kinloop/dense/voxel_samples.hpp"

namespace kinloop {

/// What all images said about one voxel.
struct Voxel {
  VoxelKey key = 0;
  uint32_t pixels = 0;
  std::array<uint32_t, 3> steps{};
  std::array<uint32_t, 3> colors{};
  uint16_t views = 0;      ///< images that saw it; stays at the most it can hold
  uint16_t last_view = 0;  ///< low bits of the latest one's number
};

/// Voxels found by key: a table of indices with linear probing over a plain list.
class VoxelGrid {
 public:
  /// Adds a sample of image number `view`; images come one after the other, each with a number of its own.
  void add(const VoxelSample& sample, uint32_t view);

  /// The voxels in the order in which they were first seen.
  [[nodiscard]] const std::vector<Voxel>& voxels() const { return voxels_; }

 private:
  Voxel& find_or_insert(VoxelKey key);
  void grow_table();

  std::vector<uint32_t> table_;  // index into voxels_ plus one; 0 = free
  std::vector<Voxel> voxels_;
};

/// Mean position of a voxel's pixels, metres.
Eigen::Vector3f mean_point(const Voxel& voxel, double voxel_m);

/// Mean colour of a voxel's pixels.
Rgb mean_color(const Voxel& voxel);

}  // namespace kinloop
