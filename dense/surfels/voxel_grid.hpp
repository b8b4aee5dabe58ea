#pragma once
// In: voxel samples of successive images. Out: their fusion per voxel.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dense/surfels/voxel_samples.hpp"

namespace kinloop {

/// Edge length of a cell as a power of two, in voxels.
constexpr int kCellBits = 2;
constexpr size_t kVoxelsPerCell = size_t{1} << (3 * kCellBits);

/// Key of the first voxel of the cell that contains a voxel.
constexpr VoxelKey cell_of(VoxelKey key) {
  return aligned_key(key, kCellBits);
}

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

/// Voxels by key. A hash table finds the cell of 4 x 4 x 4 voxels around a key, the cell its voxel.
/// Successive samples of an image mostly lie in the same cell, so that few need the table.
class VoxelGrid {
 public:
  /// Adds those of `samples` with indices `which`, all of image number `view`; the samples of an image must
  /// be added consecutively.
  void add(std::span<const VoxelSample> samples, std::span<const uint32_t> which, uint32_t view);

  /// Adds one sample.
  void add(const VoxelSample& sample, uint32_t view);

  /// Returns the voxel, or null if it has no sample.
  [[nodiscard]] const Voxel* find(VoxelKey key) const;

  /// The voxels in order of first insertion.
  [[nodiscard]] const std::vector<Voxel>& voxels() const { return voxels_; }

  /// Removes all voxels with keys from `key` on.
  void erase_from(VoxelKey key);

 private:
  struct Cell {
    VoxelKey corner = 0;                           // key of its first voxel
    std::array<uint32_t, kVoxelsPerCell> voxel{};  // index into voxels_ plus one; 0 = no sample
  };

  uint32_t find_or_insert(VoxelKey key);
  Cell& cell_at(VoxelKey corner);
  [[nodiscard]] size_t slot_of(VoxelKey corner) const;
  void rebuild_table(size_t size);

  std::vector<uint32_t> table_;  // index into cells_ plus one; 0 = free
  std::vector<Cell> cells_;
  std::vector<Voxel> voxels_;
  size_t last_cell_ = 0;  // of the latest insertion
};

/// Mean position of a voxel's points, metres.
Eigen::Vector3f mean_point(const Voxel& voxel, double voxel_m);

/// Mean colour of a voxel's points.
Rgb mean_color(const Voxel& voxel);

}  // namespace kinloop
