#pragma once
// In: notifications from Slam, on its thread. Out: the events since the last call of take(), on the viewer's
// thread. Stores the latest state and small facts; never blocks Slam.

#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/slam/listener.hpp"
#include "viewer/scene/incremental_mesh.hpp"
#include "viewer/scene/wire_format.hpp"

namespace kinloop {

/// Pose and status of a frame.
struct FrameEvent {
  int64_t stamp_ns = 0;
  TrackingOutcome outcome = TrackingOutcome::kLost;
  TrackingMethod method = TrackingMethod::kKeypoints;
  KeyframeId reference;
  SE3 T_reference_camera;
  int inliers = 0;
  bool doubtful = false;
};

/// The images of a frame.
struct ImageEvent {
  KeyframeId keyframe;  ///< valid if the frame is a keyframe
  std::shared_ptr<const Frame> frame;
  std::vector<LandmarkMatch> matches;
  cv::Mat moved;  ///< see TrackedFrame::moved
};

/// Summary of the map.
struct MapSummary {
  std::vector<SE3> T_world_keyframe;
  std::vector<std::pair<KeyframeId, KeyframeId>> loops;
  size_t landmarks = 0;
};

/// Events since the last call.
struct RunEvents {
  bool replaces_all =
      false;  ///< `frames` are all frames of the run with refined poses, not those since the last call
  std::vector<FrameEvent> frames;
  std::optional<ImageEvent> latest;
  std::deque<ImageEvent> keyframes;
  std::deque<MeshFrame> mesh_frames;
  std::vector<std::pair<KeyframeId, KeyframeId>> covisible;  ///< (older, newer) of new keyframes
  std::optional<MapSummary> map;
};

class RunFeed : public Listener {
 public:
  /// Maximum number of queued keyframe images, and of frames for the mesh; beyond it the oldest is dropped,
  /// along with its points.
  static constexpr size_t kMaxQueuedKeyframes = 32;

  /// The mesh is made of all keyframes and, in between, of every n-th frame.
  static constexpr uint32_t kMeshFrameStep = 10;

  void on_frame(const TrackedFrame& result) override;
  void on_map(const Map& map) override;

  /// Passes on the final path.
  void on_finish(std::span<const LoggedFrame> log, const Map& map);

  /// Returns the events and clears them.
  RunEvents take();

 private:
  bool is_for_mesh(const TrackedFrame& tracked);

  size_t keyframes_reported_ = 0;
  uint32_t frames_since_mesh_frame_ = 0;
  std::mutex mutex_;
  RunEvents events_;  // guarded by the mutex
};

}  // namespace kinloop
