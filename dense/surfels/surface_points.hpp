#pragma once
// In: the fused samples of all images in one region. Out: one point per surface voxel. Noise spreads a
// surface over several voxels in depth; they are merged into their mean.

#include <array>
#include <vector>

#include "dense/options.hpp"
#include "dense/surfels/voxel_grid.hpp"

namespace kinloop {

/// Voxels are distributed over this many grids by the hash of their cell. Each grid takes the images in
/// order, whichever thread fills it, so the result does not depend on threads.
constexpr int kShardBits = 4;
constexpr size_t kShards = 1 << kShardBits;
using VoxelShards = std::array<VoxelGrid, kShards>;

/// The grid of a voxel.
constexpr size_t shard_of(VoxelKey key) {
  constexpr int kKeyBits = 64;
  return hash_key(cell_of(key)) >> (kKeyBits - kShardBits);
}

/// Maximum spread of a surface by noise, voxels in either direction.
constexpr int kMaxSpreadVoxels = 8;

/// Margin around a slab whose voxels affect its points: a point may be kMaxSpreadVoxels away from its voxel
/// and be the mean of voxels as far away again.
constexpr int kHaloSlices = 2 * (kMaxSpreadVoxels + 1);

/// Voxel slices along z, from `begin` to `end` (exclusive).
struct Slab {
  int begin = 0, end = 0;

  /// Returns whether the voxel lies in the slab or at most `margin` slices outside.
  [[nodiscard]] bool contains(VoxelKey key, int margin = 0) const {
    const int z = voxel_of(key).z();
    return z >= begin - margin && z < end + margin;
  }
};

/// A candidate point of the cloud.
struct SurfacePoint {
  VoxelKey key = 0;  ///< voxel that contains it
  Eigen::Vector3f p_world = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, towards the cameras
  Rgb color{};
  int views = 0;              ///< images that observed it
  int contradictions = 0;     ///< images that contradict it, see count_contradictions
  bool seen_through = false;  ///< a view measured free space at its place
  float weight = 0;           ///< weight of its source voxel, 1/m^2
  VoxelKey origin = 0;        ///< source voxel
};

/// Returns the surface points in `slab`, one per voxel, in an order that depends on the voxels alone; those
/// of a block (see block_of) are adjacent. Within a voxel, a point that `options.min_observations` images saw
/// is preferred. The grids must hold kHaloSlices more on either side.
std::vector<SurfacePoint> surface_points(VoxelShards grids, const Slab& slab, const DenseOptions& options,
                                         int threads);

/// Edge length of a block as a power of two, in voxels.
constexpr int kBlockBits = 4;

/// Key of the block that contains a voxel.
constexpr VoxelKey block_of(VoxelKey key) {
  return aligned_key(key, kBlockBits);
}

}  // namespace kinloop
