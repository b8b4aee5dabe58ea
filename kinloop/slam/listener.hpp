#pragma once
// Files, viewer, dense maps and the terminal only listen; none of them can change the map.

#include <memory>

#include "kinloop/map/map.hpp"
#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// What became of one frame.
struct FrameResult {
  FrameId frame;
  int64_t stamp_ns = 0;
  TrackStatus status = TrackStatus::kLost;
  bool relocalized = false;  ///< found again by its words after a loss
  SE3 T_world_camera;        ///< as known now; meaningless when lost
  KeyframeId keyframe;       ///< valid where the frame became one
  KeyframeId reference;      ///< the keyframe that the pose was found relative to, and that it moves with
  SE3 T_reference_camera;
  std::vector<LandmarkMatch> matches;  ///< the landmarks seen
  TrackStats stats;
};

class Listener {
 public:
  virtual ~Listener() = default;

  /// After every frame.
  virtual void on_frame(const FrameResult& result, const PreparedFrame& frame) = 0;

  /// After keyframes were added or moved. `map` is valid during the call only.
  virtual void on_map(const Map& map) = 0;
};

}  // namespace kinloop
