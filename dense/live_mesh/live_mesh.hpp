#pragma once
// In: posed views, one after the other, and corrections of the keyframe poses. Out: a coloured mesh in pieces
// that move rigidly with keyframes; only pieces that changed.
//
// Views are fused into submaps, each anchored to a keyframe. A view updates every submap that it agrees with;
// what none of them covers becomes part of the latest one. That takes new surface from a few keyframes only,
// so that no submap is so long that it would have to bend when the map is corrected. Where submaps overlap,
// the older one shows the surface.

#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dense/live_mesh/submap.hpp"

namespace kinloop {

struct LiveMeshOptions {
  double voxel_m = 0.01;
  DepthLimits limits = {};
  /// Most blocks of 4 KiB with voxels in memory. For more, the submap that was not seen for longest is
  /// released.
  size_t max_blocks = 16384;
};

/// A piece of the mesh, in the camera frame of its anchor keyframe.
struct MeshPiece {
  uint32_t index = 0;  ///< the same for all states of a piece
  KeyframeId anchor;
  SurfacePiece surface;
};

class LiveMesh {
 public:
  explicit LiveMesh(const LiveMeshOptions& options);

  /// Sets the poses of all keyframes.
  void correct(std::span<const SE3> T_world_keyframe);

  /// Fuses a view. Its pose is relative to a keyframe near it, of which the pose is known.
  void fuse(FusionView view, KeyframeId keyframe, const SE3& T_keyframe_camera);

  /// Returns at most `most` pieces that changed much: new ones, those that gained surface, and those of three
  /// times as many views as before.
  /// With `all` also those that changed little. A piece may be empty.
  std::vector<MeshPiece> take_changed(size_t most, bool all);

  /// Number of blocks with voxels in memory.
  [[nodiscard]] size_t blocks_in_memory() const;

  [[nodiscard]] size_t submaps() const { return parts_.size(); }

 private:
  struct Part {
    Submap submap;
    KeyframeId newest;                    // keyframe that it took new surface from
    uint32_t keyframes = 1;               // that it took new surface from
    uint64_t last_view = 0;               // number of the last view that was fused into it
    std::vector<size_t> older = {};       // parts that show what both have, in order
    std::vector<uint32_t> piece_of = {};  // index of the piece of each chunk; kNoPiece: none yet
  };

  using WantedBlock = std::pair<size_t, VoxelKey>;  // of which part

  [[nodiscard]] SE3 pose(const Part& part) const { return T_world_keyframe_[part.submap.anchor().value]; }
  [[nodiscard]] std::vector<ColorPair> color_pairs(const FusionView& view,
                                                   std::span<const Eigen::Vector3f> samples,
                                                   const SE3& T_world_camera,
                                                   std::span<const size_t> parts) const;
  [[nodiscard]] std::vector<size_t> agreeing_parts(std::span<const Eigen::Vector3f> samples,
                                                   const SE3& T_world_camera) const;
  std::vector<WantedBlock> wanted_blocks(std::span<const Eigen::Vector3f> samples, const SE3& T_world_camera,
                                         KeyframeId keyframe, std::vector<size_t>& parts);
  void allocate(std::vector<WantedBlock> blocks);
  size_t part_for_new_surface(KeyframeId keyframe, double new_share, std::vector<size_t>& parts);
  void link(std::span<const size_t> parts);
  [[nodiscard]] std::optional<size_t> least_recently_seen() const;
  void take_stale(size_t part, size_t most, std::vector<MeshPiece>& pieces);
  void retire(size_t most, std::vector<MeshPiece>& pieces);
  std::optional<MeshPiece> take(size_t part, size_t chunk);

  LiveMeshOptions options_;
  TsdfScale scale_;
  std::vector<SE3> T_world_keyframe_;
  std::deque<Part> parts_;
  std::vector<MeshPiece> released_;     // the last states of pieces whose voxels were released
  ColorGain gain_ = ColorGain::Ones();  // of the last view
  uint64_t views_ = 0;
  uint32_t pieces_ = 0;
};

}  // namespace kinloop
