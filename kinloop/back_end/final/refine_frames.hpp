#pragma once
// Refines the poses of frames against the landmarks that each observed.

#include <deque>

#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/optimize/pose/absolute_pose.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// What the poses of frames are refined with.
struct FrameRefinement {
  const Map& map;
  const Sensor& sensor;
  const AbsolutePoseOptions& options;
};

/// Selects the tracked frames to refine.
enum class FrameSelection {
  kAll,
  kNearKeyframes,  ///< those that keyframe velocities are computed from
};

/// Refines the poses of tracked frames against the landmarks they observed in the current map. The result
/// does not depend on `threads`.
FrameLog refine_frames(FrameLog log, const FrameRefinement& refinement, FrameSelection which, int threads);

/// How much of a log is kept for refinement at the end of a run.
struct LogLimits {
  /// The latest frames with their observations, 13 kB each; a minute at 30 Hz.
  size_t refinable_frames = 1800;
  /// The latest lost frames with their features, 100 kB each.
  size_t lost_frames = 500;
};

/// Bounds the memory of the log of a long run. A frame beyond the limit is refined on the map of that moment
/// and keeps its pose relative to a keyframe, which follows all later corrections.
class LogLimiter {
 public:
  explicit LogLimiter(const LogLimits& limits = {}) : limits_(limits) {}

  /// Call after each frame that is added to the log. `first` is the first frame of the run.
  void apply(FrameLog& log, size_t first, const FrameRefinement& refinement);

 private:
  LogLimits limits_;
  std::deque<size_t> lost_;  // frames with features
};

}  // namespace kinloop
