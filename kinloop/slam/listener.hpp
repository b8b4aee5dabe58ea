#pragma once
// Listeners observe a run: files, viewer, dense maps and the terminal. They cannot change the map.

#include <memory>

#include "kinloop/map/map.hpp"
#include "kinloop/tracking/local_map_tracking.hpp"

namespace kinloop {

/// Result of processing one frame.
struct FrameResult {
  FrameId frame;
  int64_t stamp_ns = 0;
  TrackStatus status = TrackStatus::kLost;
  bool relocalized = false;  ///< located by place recognition after tracking was lost
  SE3 T_world_camera;        ///< at the time of the event; undefined if lost
  KeyframeId keyframe;       ///< valid if the frame became a keyframe
  KeyframeId reference;      ///< the keyframe that the pose is relative to and moves with
  SE3 T_reference_camera;
  std::vector<LandmarkMatch> matches;  ///< observed landmarks
  TrackStats stats;
};

class Listener {
 public:
  virtual ~Listener() = default;

  /// Called after every frame.
  virtual void on_frame(const FrameResult& result, const PreparedFrame& frame) = 0;

  /// Called after keyframes were added or moved. `map` is valid only during the call.
  virtual void on_map(const Map& map) = 0;
};

}  // namespace kinloop
