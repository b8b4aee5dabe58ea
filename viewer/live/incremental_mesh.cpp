#include "viewer/live/incremental_mesh.hpp"

#include <algorithm>

#include "dense/undistorted_images.hpp"
#include "kinloop/tracking/front_end.hpp"

namespace kinloop {
namespace {

/// A frame is fused once the map has so many keyframes after its own: by then local adjustment has moved it.
constexpr size_t kLaterKeyframes = 2;

/// Finer voxels would fill the memory for them with a single view.
constexpr double kMinVoxel_m = 0.01;

/// It does not wait longer than until so many others do: a camera at rest makes no keyframes.
constexpr size_t kMaxWaiting = 8;

}  // namespace

IncrementalMesh::IncrementalMesh(const PinholeCamera& camera, const ViewerOptions& options)
    : options_(options),
      raw_pixels_(undistortion_of(camera)),
      mesh_({.voxel_m = std::max(options.voxel_m, kMinVoxel_m), .limits = options.limits}) {}

void IncrementalMesh::add(const std::deque<MeshFrame>& frames) {
  queue_.insert(queue_.end(), frames.begin(), frames.end());
  while (queue_.size() > kMaxQueuedFrames) drop_oldest();
}

void IncrementalMesh::drop_oldest() {
  const auto between =
      std::ranges::find_if(queue_, [](const MeshFrame& frame) { return !frame.is_keyframe; });
  queue_.erase(between == queue_.end() ? queue_.begin() : between);
}

std::vector<MeshPiece> IncrementalMesh::update(std::span<const SE3> T_world_keyframe,
                                               const DenseCamera& camera, bool finished) {
  mesh_.correct(T_world_keyframe);
  auto changed = mesh_.take_changed(kMaxPieces, finished && queue_.empty());
  if (changed.empty() && is_ready(T_world_keyframe.size(), finished)) {
    fuse(queue_.front(), camera);
    queue_.pop_front();
  }
  return changed;
}

/// Whether the first queued frame is to be fused in a map of so many keyframes.
bool IncrementalMesh::is_ready(size_t keyframes, bool finished) const {
  if (queue_.empty() || queue_.front().reference.value >= keyframes) return false;
  return finished || queue_.size() > kMaxWaiting ||
         queue_.front().reference.value + kLaterKeyframes < keyframes;
}

void IncrementalMesh::fuse(const MeshFrame& queued, const DenseCamera& camera) {
  const Frame& frame = *queued.frame;
  FusionView view = make_fusion_view({frame.color.bgr(), depth_at_rest_m(frame, queued.moved)}, camera,
                                     raw_pixels_, options_.limits);
  view.velocity = queued.velocity;
  view.depth_stamp_difference_s = static_cast<double>(depth_stamp_difference_s(frame));
  mesh_.fuse(view, queued.reference, queued.T_reference_camera);
  ++fused_;
}

}  // namespace kinloop
