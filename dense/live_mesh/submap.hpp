#pragma once
// A part of the live mesh: a signed distance field that moves rigidly with the keyframe it is anchored to, so
// that a correction of the map moves what it holds without touching it. All points are in that keyframe's
// camera frame, metres.

#include <algorithm>
#include <optional>
#include <unordered_map>

#include <Eigen/Geometry>

#include "dense/live_mesh/tsdf_blocks.hpp"
#include "kinloop/core/ids.hpp"

namespace kinloop {

/// A cube of blocks. Its surface is one piece of the mesh.
struct MeshChunk {
  VoxelKey first = 0;            ///< key of its first voxel
  std::vector<uint32_t> blocks;  ///< their indices
  uint32_t views = 0;            ///< that changed it
  uint32_t extracted_views = 0;  ///< of these, those that its piece shows
  bool has_grown = false;        ///< in it or at its border is surface that its piece does not show

  /// Whether its piece does not show all of it.
  [[nodiscard]] bool is_stale() const { return has_grown || views > extracted_views; }

  /// Whether its piece lacks surface, or most of the views: the more are fused, the less each changes.
  [[nodiscard]] bool is_due() const {
    constexpr uint32_t kFactor = 3, kGrowing = 4;
    const uint32_t many = kFactor * extracted_views;
    const uint32_t wanted = has_grown ? std::min(many, extracted_views + kGrowing) : many;
    return views > 0 && (extracted_views == 0 || views >= wanted);
  }
};

/// Of points of a view, how many a submap knows to be near a surface or in free space, and how many of these
/// are near a surface.
struct ViewAgreement {
  size_t known = 0, agreeing = 0;
};

class Submap {
 public:
  Submap(KeyframeId anchor, const TsdfScale& scale) : anchor_(anchor), scale_(scale) {}

  [[nodiscard]] KeyframeId anchor() const { return anchor_; }
  [[nodiscard]] const std::vector<MeshChunk>& chunks() const { return chunks_; }

  /// Whether the voxels were released: nothing can be fused or extracted any more.
  [[nodiscard]] bool is_released() const { return released_; }

  /// Number of blocks with voxels.
  [[nodiscard]] size_t blocks_in_memory() const { return released_ ? 0 : blocks_.all().size(); }

  /// Whether a point is within `margin_m` of the box around the blocks.
  [[nodiscard]] bool is_near(const Eigen::Vector3f& point, double margin_m) const;

  /// Whether the surface at a point that is seen from `eye` is this submap's: in one of its blocks, or after
  /// its release where it shows one.
  [[nodiscard]] bool owns(const Eigen::Vector3f& point, const Eigen::Vector3f& eye) const;

  /// Whether its pieces show a surface at a point, or up to two voxels before or behind it along a unit
  /// vector.
  [[nodiscard]] bool shows(const Eigen::Vector3f& point, const Eigen::Vector3f& along) const;

  /// Of points that are seen from `eye`.
  [[nodiscard]] ViewAgreement agreement(std::span<const Eigen::Vector3f> points,
                                        const Eigen::Vector3f& eye) const;

  /// The colour of the surface at a point; nullopt if none is known.
  [[nodiscard]] std::optional<Rgb> color_at(const Eigen::Vector3f& point) const;

  /// The key of the block that contains a point, and whether it is there.
  [[nodiscard]] VoxelKey block_at(const Eigen::Vector3f& point) const;
  [[nodiscard]] bool has_block(VoxelKey block) const { return blocks_.find(block) != nullptr; }

  /// Adds a block, if it is not there.
  void touch(VoxelKey block);

  /// Fuses a view into the blocks that exist.
  void fuse(const FusionView& view, const DepthTiles& tiles, const SE3& T_camera_submap);

  /// Marks all chunks, to be extracted again.
  void mark_all();

  /// Extracts the surface of a chunk.
  [[nodiscard]] SurfacePiece extract(size_t chunk) const;

  /// Notes what of a chunk is now shown, all that has been fused so far.
  void note_shown(size_t chunk, const SurfacePiece& piece);

  /// Frees the voxels. What is shown remains known.
  void release();

 private:
  [[nodiscard]] const TsdfVoxel* nearest_voxel(const Eigen::Vector3f& point) const;
  MeshChunk& chunk_at(VoxelKey first);
  void mark_grown(VoxelKey block);

  KeyframeId anchor_;
  TsdfScale scale_;
  TsdfBlocks blocks_;
  std::vector<MeshChunk> chunks_;
  std::unordered_map<VoxelKey, uint32_t, VoxelKeyHash> chunk_index_;
  Eigen::AlignedBox3f box_;  // around the blocks, voxels
  bool released_ = false;
};

}  // namespace kinloop
