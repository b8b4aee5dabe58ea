#include "dense/live_mesh/tsdf_blocks.hpp"

namespace kinloop {

uint32_t TsdfBlocks::touch(VoxelKey first) {
  const auto [found, is_new] = index_of_.try_emplace(first, static_cast<uint32_t>(blocks_.size()));
  if (is_new) blocks_.push_back({.first = first, .voxels = std::make_unique<TsdfVoxels>()});
  return found->second;
}

const TsdfBlock* TsdfBlocks::find(VoxelKey voxel) const {
  const auto found = index_of_.find(tsdf_block_of(voxel));
  return found == index_of_.end() ? nullptr : &blocks_[found->second];
}

TsdfBlock* TsdfBlocks::find(VoxelKey voxel) {
  const auto found = index_of_.find(tsdf_block_of(voxel));
  return found == index_of_.end() ? nullptr : &blocks_[found->second];
}

void TsdfBlocks::release() {
  for (TsdfBlock& block : blocks_) block.voxels.reset();
}

}  // namespace kinloop
