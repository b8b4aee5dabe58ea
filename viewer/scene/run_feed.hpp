#pragma once
// In: what Slam tells, on its thread. Out: the news since they were last taken, on the viewer's. Holds the
// latest state and small facts; never makes Slam wait.

#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/listener.hpp"
#include "viewer/options.hpp"
#include "viewer/scene/wire.hpp"

namespace kinloop {

/// Where one frame was, and how it was found.
struct FrameNews {
  int64_t stamp_ns = 0;
  TrackStatus status = TrackStatus::kLost;
  bool relocalized = false;
  KeyframeId reference;
  SE3 T_reference_camera;
  int inliers = 0;
};

/// The images of a frame.
struct ImageNews {
  KeyframeId keyframe;  ///< where it is one
  cv::Mat color, depth_m;
  std::shared_ptr<const Features> features;
  std::vector<LandmarkMatch> matches;
};

/// The map in outline.
struct MapNews {
  std::vector<SE3> T_world_keyframe;
  std::vector<std::pair<KeyframeId, KeyframeId>> loops;
  size_t landmarks = 0;
};

/// All that happened since the last time.
struct RunNews {
  bool from_start = false;  ///< `frames` are all frames of the run, refined, not those since the last time
  std::vector<FrameNews> frames;
  std::optional<ImageNews> latest;
  std::deque<ImageNews> keyframes;
  std::vector<std::pair<KeyframeId, KeyframeId>> covisible;  ///< (older, newer) of new keyframes
  std::optional<MapNews> map;
};

class RunFeed : public Listener {
 public:
  /// Images of keyframes that wait at most; the oldest is dropped, and its points with it.
  static constexpr size_t kMostKeyframesWaiting = 32;

  explicit RunFeed(const ViewerOptions& options) : options_(options) {}

  void on_frame(const FrameResult& result, const PreparedFrame& frame) override;
  void on_map(const Map& map) override;

  /// The path as it is known at the end.
  void on_finish(std::span<const LoggedFrame> log, const Map& map);

  /// The news, which are none after that.
  RunNews take();

 private:
  ViewerOptions options_;
  size_t keyframes_told_ = 0;
  std::mutex mutex_;
  RunNews news_;  // guarded by the mutex
};

}  // namespace kinloop
