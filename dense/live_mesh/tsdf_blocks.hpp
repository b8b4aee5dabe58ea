#pragma once
// A truncated signed distance field with colours, in sparse blocks of 8 x 8 x 8 voxels. Unlike TsdfVolume it
// needs no library, takes 8 bytes per voxel, and tells which blocks have changed. Views are fused into
// the blocks that exist, and their surface is extracted in pieces.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/live_mesh/fusion_view.hpp"
#include "dense/mesh/colored_mesh.hpp"
#include "dense/surfels/voxel_samples.hpp"

namespace kinloop {

/// Edge length of a block as a power of two, in voxels.
constexpr int kTsdfBlockBits = 3;
constexpr int kTsdfBlockEdge = 1 << kTsdfBlockBits;
constexpr size_t kTsdfBlockVoxels = size_t{1} << (3 * kTsdfBlockBits);

/// A voxel of the field. All zero: not measured.
struct TsdfVoxel {
  static constexpr float kDistanceUnits = 32767;  ///< per truncation distance
  static constexpr float kWeightUnits = 1024;     ///< per view from 1 m; 64 such views saturate it
  static constexpr float kColorWeightUnits = 16;

  int16_t distance = 0;  ///< to the nearest surface, negative behind it
  uint16_t weight = 0;   ///< of the distance
  Rgb color{};
  uint8_t color_weight = 0;
};

using TsdfVoxels = std::array<TsdfVoxel, kTsdfBlockVoxels>;  // x fastest, then y

struct TsdfBlock {
  VoxelKey first = 0;                  ///< key of its first voxel
  std::unique_ptr<TsdfVoxels> voxels;  ///< null: released
  /// The cells of 2 x 2 x 2 voxels that hold a vertex of the extracted mesh, see drawn_bit.
  uint64_t drawn = 0;
  bool has_solid = false;  ///< whether a voxel lies behind a surface
};

/// Key of the first voxel of the block that contains a voxel.
constexpr VoxelKey tsdf_block_of(VoxelKey key) {
  return aligned_key(key, kTsdfBlockBits);
}

/// Index, in its block, of a voxel given by its coordinates.
inline size_t index_in_tsdf_block(const Eigen::Vector3i& voxel) {
  constexpr int kMask = kTsdfBlockEdge - 1;
  return static_cast<size_t>((voxel.x() & kMask) | (voxel.y() & kMask) << kTsdfBlockBits |
                             (voxel.z() & kMask) << (2 * kTsdfBlockBits));
}

/// The bit, in `drawn` of its block, of the cell that contains a voxel.
inline uint64_t drawn_bit(const Eigen::Vector3i& voxel) {
  const Eigen::Vector3i half = voxel.unaryExpr([](int x) { return (x & (kTsdfBlockEdge - 1)) >> 1; });
  return uint64_t{1} << (half.x() | half.y() << 2 | half.z() << 4);
}

/// The voxel that contains a point, both in voxels.
inline Eigen::Vector3i voxel_at(const Eigen::Vector3f& p_voxels) {
  return p_voxels.array().floor().cast<int>();
}

inline VoxelKey voxel_key(const Eigen::Vector3i& voxel) {
  return voxel_key(voxel.x(), voxel.y(), voxel.z());
}

/// Hashes keys for the containers of the standard library.
struct VoxelKeyHash {
  size_t operator()(VoxelKey key) const {
    constexpr int kShift = 20;  // the highest bits are mixed best
    return hash_key(key) >> kShift;
  }
};

/// Blocks by the key of their first voxel.
class TsdfBlocks {
 public:
  /// Returns the index of the block, which is added if there is none.
  uint32_t touch(VoxelKey first);

  /// Returns the block that contains a voxel; null if there is none.
  [[nodiscard]] const TsdfBlock* find(VoxelKey voxel) const;
  [[nodiscard]] TsdfBlock* find(VoxelKey voxel);

  /// Frees the voxels of all blocks. What is drawn remains known.
  void release();

  [[nodiscard]] std::vector<TsdfBlock>& all() { return blocks_; }
  [[nodiscard]] const std::vector<TsdfBlock>& all() const { return blocks_; }
  TsdfBlock& operator[](uint32_t index) { return blocks_[index]; }

 private:
  std::vector<TsdfBlock> blocks_;  // in order of their addition
  std::unordered_map<VoxelKey, uint32_t, VoxelKeyHash> index_of_;
};

/// The scale of a signed distance field.
struct TsdfScale {
  double voxel_m = 0;
  double truncation_m = 0;  ///< distances are cut off there
};

struct ChangedBlock {
  uint32_t index = 0;
  bool gained_surface = false;  ///< its first one
};

/// Fuses a view into the blocks that exist: surfaces, and free space where a block has surfaces. Returns the
/// blocks that changed, in order.
std::vector<ChangedBlock> fuse_view(TsdfBlocks& blocks, const FusionView& view, const DepthTiles& tiles,
                                    const SE3& T_camera_blocks, const TsdfScale& scale);

/// Edge length of a chunk as a power of two, in voxels: its vertices, at most one per voxel, can be counted
/// with 16 bits.
constexpr int kChunkBits = 5;

/// Key of the first voxel of the chunk that contains a voxel.
constexpr VoxelKey chunk_of(VoxelKey key) {
  return aligned_key(key, kChunkBits);
}

/// A mesh in the frame of its blocks, with a unit normal towards the free side for each vertex.
struct SurfacePiece {
  ColoredMesh mesh;
  std::vector<Eigen::Vector3f> normals;
};

/// Extracts the surface across the edges of a chunk's voxels, where voxels have at least `min_weight`, by
/// surface nets. `present` are the indices of the blocks of the chunk.
SurfacePiece extract_piece(const TsdfBlocks& blocks, VoxelKey chunk, std::span<const uint32_t> present,
                           const TsdfScale& scale, double min_weight);

/// Returns the piece without the triangles all of whose corners are left out, and without vertices that no
/// triangle uses. `is_left_out(vertex)` is called once for each.
SurfacePiece without_triangles(const SurfacePiece& piece,
                               const std::function<bool(size_t vertex)>& is_left_out);

}  // namespace kinloop
