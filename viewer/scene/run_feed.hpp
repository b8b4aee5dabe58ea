#pragma once
// In: what Slam tells, on its thread. Out: the events since they were last taken, on the viewer's. Holds the
// latest state and small facts; never makes Slam wait.

#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/listener.hpp"
#include "viewer/options.hpp"
#include "viewer/scene/wire_format.hpp"

namespace kinloop {

/// Where one frame was, and how it was found.
struct FrameEvent {
  int64_t stamp_ns = 0;
  TrackStatus status = TrackStatus::kLost;
  bool relocalized = false;
  KeyframeId reference;
  SE3 T_reference_camera;
  int inliers = 0;
};

/// The images of a frame.
struct ImageEvent {
  KeyframeId keyframe;  ///< where it is one
  cv::Mat color, depth_m;
  std::shared_ptr<const Features> features;
  std::vector<LandmarkMatch> matches;
};

/// The map in outline.
struct MapSummary {
  std::vector<SE3> T_world_keyframe;
  std::vector<std::pair<KeyframeId, KeyframeId>> loops;
  size_t landmarks = 0;
};

/// All that happened since the last time.
struct RunEvents {
  bool replaces_all = false;  ///< `frames` are all frames of the run, refined, not those since the last time
  std::vector<FrameEvent> frames;
  std::optional<ImageEvent> latest;
  std::deque<ImageEvent> keyframes;
  std::vector<std::pair<KeyframeId, KeyframeId>> covisible;  ///< (older, newer) of new keyframes
  std::optional<MapSummary> map;
};

class RunFeed : public Listener {
 public:
  /// Images of keyframes that wait at most; the oldest is dropped, and its points with it.
  static constexpr size_t kMaxQueuedKeyframes = 32;

  explicit RunFeed(const ViewerOptions& options) : options_(options) {}

  void on_frame(const FrameResult& result, const PreparedFrame& frame) override;
  void on_map(const Map& map) override;

  /// The path as it is known at the end.
  void on_finish(std::span<const LoggedFrame> log, const Map& map);

  /// The events, which are none after that.
  RunEvents take();

 private:
  ViewerOptions options_;
  size_t keyframes_reported_ = 0;
  std::mutex mutex_;
  RunEvents events_;  // guarded by the mutex
};

}  // namespace kinloop
