#pragma once
// In: notifications from Slam, on its thread. Out: the scene of the run, part by part, on the viewer's
// thread.

#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"
#include "kinloop/slam/listener.hpp"
#include "viewer/live/incremental_mesh.hpp"
#include "viewer/scene/incremental_cloud.hpp"
#include "viewer/scene/scene.hpp"
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

/// Takes notifications from Slam, on its thread, and gives the events since the last call of take(), on the
/// viewer's thread. Stores the latest state and small facts; never blocks Slam.
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

/// Properties of a run known before it begins.
struct RunInfo {
  std::string input;
  size_t frames = 0;  ///< 0 if unknown
  RgbdCamera camera;
  Trajectory truth;  ///< empty if there is none
  ViewerOptions options;
  std::optional<Eigen::Vector3d> up = {};  ///< in the world; nullopt: estimated
};

/// State of the run, in addition to Slam's events.
struct RunState {
  std::string stage = "mapping";
  std::string message = {};                ///< latest message
  std::vector<std::string> warnings = {};  ///< where the input contradicts itself
  std::vector<std::string> hints = {};     ///< what spoils the recording now, and what to do
  bool paused = false;
  std::optional<SensorEstimate> sensor = {};  ///< as estimated so far
};

class RunScene {
 public:
  RunScene(Scene& scene, RunInfo info);

  /// Images are encoded only while a browser is connected (`watched`).
  void update(const RunEvents& events, const RunState& state, bool watched);

 private:
  using Clock = std::chrono::steady_clock;

  void add_frames(const RunEvents& events);
  void update_map(const MapSummary& map);
  void add_keyframe(const ImageEvent& image);
  void update_mesh(const RunEvents& events, const RunState& state);
  void show_path(size_t first);
  void show_doubt();
  void show_images(const ImageEvent& image);
  void show_camera();
  void show_status(const RunState& state);
  void compare_with_truth();
  [[nodiscard]] Trajectory path() const;
  [[nodiscard]] double frames_per_second();

  Scene& scene_;
  RunInfo info_;
  IncrementalCloud cloud_;
  std::optional<IncrementalMesh> mesh_;  // if wanted
  bool finished_ = false;
  std::vector<FrameEvent> frames_;
  std::vector<std::pair<KeyframeId, KeyframeId>> covisible_;
  std::vector<FrameRange> doubt_;
  MapSummary map_;
  size_t relocalizations_ = 0;
  double ate_m_ = 0;
  std::deque<std::pair<Clock::time_point, size_t>> counts_;  // frame counts over the last second or so
  Eigen::Vector3d up_ = {0, -1, 0};
  Clock::time_point next_image_, next_comparison_, next_up_;
};

}  // namespace kinloop
