#include "dense/live_mesh/submap.hpp"

#include <cmath>

namespace kinloop {
namespace {

/// Weight from which on a voxel is known, see MeshOptions::min_weight: about one view from 2.7 m.
constexpr double kMinWeight = 0.02;

/// A point agrees with a surface at less than that share of the truncation distance.
constexpr float kAgreeing = 0.5F;

/// In front of and behind a surface, voxels, within which another one is the same.
constexpr float kSame_voxels = 2;

bool is_at_surface(const TsdfVoxel& voxel) {
  return static_cast<float>(std::abs(voxel.distance)) < kAgreeing * TsdfVoxel::kDistanceUnits;
}

}  // namespace

bool Submap::is_near(const Eigen::Vector3f& point, double margin_m) const {
  return static_cast<double>(box_.exteriorDistance(Eigen::Vector3f(point / scale_.voxel_m))) *
             scale_.voxel_m <
         margin_m;
}

bool Submap::owns(const Eigen::Vector3f& point, const Eigen::Vector3f& eye) const {
  if (released_) return shows(point, (point - eye).normalized());
  return has_block(block_at(point));
}

bool Submap::shows(const Eigen::Vector3f& point, const Eigen::Vector3f& along) const {
  for (const float step : {0.0F, -kSame_voxels, kSame_voxels}) {
    const Eigen::Vector3i voxel = voxel_at(point / scale_.voxel_m + step * along);
    const TsdfBlock* block = blocks_.find(voxel_key(voxel));
    if (block != nullptr && (block->drawn & drawn_bit(voxel)) != 0) return true;
  }
  return false;
}

ViewAgreement Submap::agreement(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& eye) const {
  ViewAgreement found;
  for (const Eigen::Vector3f& point : points) {
    if (released_) {
      const bool agrees = shows(point, (point - eye).normalized());
      const TsdfBlock* block = blocks_.find(voxel_key(voxel_at(point / scale_.voxel_m)));
      found.known += agrees || (block != nullptr && block->drawn != 0) ? 1 : 0;
      found.agreeing += agrees ? 1 : 0;
      continue;
    }
    const TsdfVoxel* there = nearest_voxel(point);
    if (there == nullptr || there->weight == 0) continue;
    ++found.known;
    found.agreeing += is_at_surface(*there) ? 1 : 0;
  }
  return found;
}

const TsdfVoxel* Submap::nearest_voxel(const Eigen::Vector3f& point) const {
  const Eigen::Vector3i voxel = voxel_at(point / scale_.voxel_m + Eigen::Vector3f::Constant(0.5F));
  const TsdfBlock* block = blocks_.find(voxel_key(voxel));
  if (block == nullptr || block->voxels == nullptr) return nullptr;
  return &(*block->voxels)[index_in_tsdf_block(voxel)];
}

std::optional<Rgb> Submap::color_at(const Eigen::Vector3f& point) const {
  const TsdfVoxel* there = nearest_voxel(point);
  if (there == nullptr || there->color_weight == 0 || !is_at_surface(*there)) return std::nullopt;
  return there->color;
}

VoxelKey Submap::block_at(const Eigen::Vector3f& point) const {
  return tsdf_block_of(voxel_key(voxel_at(point / scale_.voxel_m)));
}

void Submap::touch(VoxelKey block) {
  const auto index = static_cast<uint32_t>(blocks_.all().size());
  if (blocks_.touch(block) != index) return;
  chunk_at(chunk_of(block)).blocks.push_back(index);
  const Eigen::Vector3f corner = voxel_of(block).cast<float>();
  box_.extend(corner);
  box_.extend(Eigen::Vector3f(corner + Eigen::Vector3f::Constant(kTsdfBlockEdge)));
}

/// Marks the chunks that a block belongs to or touches.
void Submap::mark_grown(VoxelKey block) {
  const Eigen::Vector3i first = voxel_of(block);
  chunks_[chunk_index_.at(chunk_of(block))].has_grown = true;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      const Eigen::Vector3i neighbor = first + side * kTsdfBlockEdge * Eigen::Vector3i::Unit(axis);
      const auto found = chunk_index_.find(chunk_of(voxel_key(neighbor)));
      if (found != chunk_index_.end()) chunks_[found->second].has_grown = true;
    }
  }
}

void Submap::fuse(const FusionView& view, const DepthTiles& tiles, const SE3& T_camera_submap) {
  if (released_) return;
  std::vector<bool> changed(chunks_.size());
  for (const ChangedBlock& block : fuse_view(blocks_, view, tiles, T_camera_submap, scale_)) {
    const VoxelKey first = blocks_[block.index].first;
    changed[chunk_index_.at(chunk_of(first))] = true;
    if (block.gained_surface) mark_grown(first);
  }
  for (size_t i = 0; i < chunks_.size(); ++i) chunks_[i].views += changed[i] ? 1 : 0;
}

void Submap::mark_all() {
  for (MeshChunk& chunk : chunks_) chunk.has_grown = true;
}

SurfacePiece Submap::extract(size_t chunk) const {
  return extract_piece(blocks_, chunks_[chunk].first, chunks_[chunk].blocks, scale_, kMinWeight);
}

void Submap::note_shown(size_t chunk, const SurfacePiece& piece) {
  for (const uint32_t block : chunks_[chunk].blocks) blocks_[block].drawn = 0;
  for (const Eigen::Vector3f& point : piece.mesh.points) {
    const Eigen::Vector3i voxel = voxel_at(point / scale_.voxel_m);
    if (TsdfBlock* block = blocks_.find(voxel_key(voxel))) block->drawn |= drawn_bit(voxel);
  }
  chunks_[chunk].extracted_views = chunks_[chunk].views;
  chunks_[chunk].has_grown = false;
}

void Submap::release() {
  blocks_.release();
  released_ = true;
}

MeshChunk& Submap::chunk_at(VoxelKey first) {
  const auto [found, is_new] = chunk_index_.try_emplace(first, static_cast<uint32_t>(chunks_.size()));
  if (is_new) chunks_.push_back({.first = first, .blocks = {}});
  return chunks_[found->second];
}

}  // namespace kinloop
