#pragma once
// In: a view and its pose in the frame of some blocks. Out: the blocks with the view in them.

#include <vector>

#include "dense/live_mesh/fusion_view.hpp"
#include "dense/live_mesh/tsdf_blocks.hpp"

namespace kinloop {

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

}  // namespace kinloop
