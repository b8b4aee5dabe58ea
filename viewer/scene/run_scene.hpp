#pragma once
// In: events of a run. Out: its scene, part by part.

#include <chrono>
#include <optional>
#include <string>

#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"
#include "viewer/scene/incremental_cloud.hpp"
#include "viewer/scene/incremental_mesh.hpp"
#include "viewer/scene/run_feed.hpp"
#include "viewer/scene/scene.hpp"

namespace kinloop {

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
