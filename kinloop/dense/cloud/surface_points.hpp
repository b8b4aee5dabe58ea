#pragma once
// In: what all images said about the voxels of one region. Out: one point per voxel of surface. Noise spreads
// a surface over several voxels in depth; they are drawn together to its mean.

#include <array>
#include <vector>

#include "kinloop/dense/cloud/voxel_grid.hpp"
#include "kinloop/dense/options.hpp"

namespace kinloop {

/// Space is binned out to this many grids by the voxels' scattered keys. Each grid takes the images in their
/// order whichever thread fills it, so that nothing depends on threads.
constexpr int kShardBits = 4;
constexpr size_t kShards = 1 << kShardBits;
using VoxelShards = std::array<VoxelGrid, kShards>;

/// The grid that a voxel belongs to.
constexpr size_t shard_of(VoxelKey key) {
  constexpr int kKeyBits = 64;
  return hash_key(key) >> (kKeyBits - kShardBits);
}

/// How far a surface may be spread by noise at most, voxels either way.
constexpr int kMaxSpreadVoxels = 8;

/// How far from a slab voxels have a say in its points: one may come from kMaxSpreadVoxels away, and be the
/// mean of what is as far away again.
constexpr int kHaloSlices = 2 * (kMaxSpreadVoxels + 1);

/// Slices of voxels of one z: from `begin` to before `end`.
struct Slab {
  int begin = 0, end = 0;

  /// Whether a voxel lies in it, or at most `margin` slices beside.
  [[nodiscard]] bool contains(VoxelKey key, int margin = 0) const {
    const int z = voxel_of(key).z();
    return z >= begin - margin && z < end + margin;
  }
};

/// A point of the cloud to be.
struct SurfacePoint {
  VoxelKey key = 0;  ///< of the voxel it lies in
  Eigen::Vector3f p_world;
  Eigen::Vector3f normal;  ///< unit, towards the cameras
  Rgb color{};
  int views = 0;                  ///< images that saw it
  int unoccluded_views = 0;       ///< images that could see its place, occupied or not
  int free_space_violations = 0;  ///< images that saw through it
  float weight = 0;               ///< how sure the voxel was that it comes from, 1/m^2
  VoxelKey origin = 0;            ///< that voxel
};

/// The points of the surfaces in `slab`, one per voxel, in an order that depends on the voxels alone: those
/// of a block (see block_of) stand together. Of one voxel a point that `options.min_observations` images saw
/// is preferred. The grids must hold kHaloSlices more on either side.
std::vector<SurfacePoint> surface_points(VoxelShards grids, const Slab& slab, const DenseOptions& options,
                                         int threads);

/// Voxels along the edge of a block.
constexpr int kBlockBits = 4;

/// The block of voxels that a voxel lies in, in the order of keys.
constexpr VoxelKey block_of(VoxelKey key) {
  constexpr VoxelKey kAxis = ((VoxelKey{1} << kVoxelAxisBits) - 1) >> kBlockBits << kBlockBits;
  return key & (kAxis | kAxis << kVoxelAxisBits | kAxis << (2 * kVoxelAxisBits));
}

}  // namespace kinloop
