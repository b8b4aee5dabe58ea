#pragma once
// In: news of a run. Out: its scene, part by part.

#include <chrono>
#include <string>

#include "kinloop/geometry/camera.hpp"
#include "viewer/scene/growing_cloud.hpp"
#include "viewer/scene/run_feed.hpp"
#include "viewer/scene/scene.hpp"

namespace kinloop {

/// What is known of a run before it begins.
struct RunBasics {
  std::string input;
  size_t frames = 0;  ///< 0 where it is not known
  RgbdCamera camera;
  Trajectory truth;  ///< empty where there is none
  ViewerOptions options;
};

/// How the run goes, beside what Slam tells.
struct RunState {
  std::string stage = "mapping";
  std::string message;  ///< the last thing worth telling
  bool paused = false;
};

class RunScene {
 public:
  RunScene(Scene& scene, RunBasics basics);

  /// Images are made only while somebody `watches`.
  void take_in(const RunNews& news, const RunState& state, bool watched);

 private:
  using Clock = std::chrono::steady_clock;

  void take_frames(const RunNews& news);
  void take_map(const MapNews& map);
  void take_keyframe(const ImageNews& image);
  void show_path(size_t first);
  void show_images(const ImageNews& image);
  void show_camera();
  void show_status(const RunState& state);
  void compare_with_truth();
  [[nodiscard]] Trajectory path() const;
  [[nodiscard]] double frames_per_second();

  Scene& scene_;
  RunBasics basics_;
  GrowingCloud cloud_;
  std::vector<FrameNews> frames_;
  std::vector<std::pair<KeyframeId, KeyframeId>> covisible_;
  MapNews map_;
  size_t relocalizations_ = 0;
  double ate_m_ = 0;
  std::deque<std::pair<Clock::time_point, size_t>> counts_;  // frames there were, over the last second or so
  Eigen::Vector3d up_ = {0, -1, 0};
  Clock::time_point next_image_, next_comparison_, next_up_;
};

}  // namespace kinloop
