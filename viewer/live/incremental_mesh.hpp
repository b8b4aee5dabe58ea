#pragma once
// In: frames of a run and the poses of its keyframes. Out: the pieces of the live mesh that changed.

#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "dense/live_mesh/live_mesh.hpp"
#include "kinloop/sensor/frame.hpp"
#include "session/plan/viewer_options.hpp"

namespace kinloop {

/// A frame for the mesh.
struct MeshFrame {
  std::shared_ptr<const Frame> frame;
  KeyframeId reference;  ///< itself, if it is a keyframe
  SE3 T_reference_camera;
  Velocity velocity;  ///< at the stamp
  cv::Mat moved;      ///< see TrackedFrame::moved
  bool is_keyframe = false;
};

class IncrementalMesh {
 public:
  IncrementalMesh(const PinholeCamera& camera, const ViewerOptions& options);

  /// Queues frames. Beyond a limit the oldest are dropped, keyframes last.
  void add(const std::deque<MeshFrame>& frames);

  /// Returns at most kMaxPieces changed pieces or, if there are none, fuses one of the queued frames, so that
  /// a call does not take long. `camera` as the poses were estimated with. A frame waits until the poses
  /// around it have been adjusted, unless the run is `finished`.
  std::vector<MeshPiece> update(std::span<const SE3> T_world_keyframe, const DenseCamera& camera,
                                bool finished);

  /// Number of frames fused so far.
  [[nodiscard]] size_t fused_frames() const { return fused_; }

  [[nodiscard]] const LiveMesh& mesh() const { return mesh_; }

 private:
  static constexpr size_t kMaxQueuedFrames = 32;
  static constexpr size_t kMaxPieces = 16;

  [[nodiscard]] bool is_ready(size_t keyframes, bool finished) const;
  void drop_oldest();
  void fuse(const MeshFrame& queued, const DenseCamera& camera);

  ViewerOptions options_;
  cv::Mat raw_pixels_;  // see undistortion_of
  LiveMesh mesh_;
  std::deque<MeshFrame> queue_;
  size_t fused_ = 0;
};

}  // namespace kinloop
