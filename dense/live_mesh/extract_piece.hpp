#pragma once
// In: blocks of a signed distance field. Out: the surface in one chunk of them, as triangles.

#include <functional>
#include <span>

#include "dense/live_mesh/fuse_view.hpp"
#include "dense/mesh/colored_mesh.hpp"

namespace kinloop {

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
