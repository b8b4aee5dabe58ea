#pragma once
// In: located frames. Out: those that show something new become keyframes of the map, with their landmarks.

#include "kinloop/slam/options.hpp"
#include "kinloop/slam/tracker.hpp"

namespace kinloop {

class Mapper {
 public:
  Mapper(const PinholeCamera& camera, const SlamOptions& options) : camera_(camera), options_(options) {}

  /// The frames that follow come after `newest`, a keyframe of a map that was loaded.
  void continue_from(KeyframeId newest) { last_keyframe_ = newest; }

  /// Whether a frame should become a keyframe: any that begins a map, and those located that show enough that
  /// is new. To be asked of each frame once, in order.
  [[nodiscard]] bool needs_keyframe(const Map& map, const FrameTracking& tracking);

  /// Adds the frame to the map: its keyframe, what it observes, new landmarks; culls those that proved bad.
  KeyframeId insert_keyframe(Map& map, const FrameTracking& tracking);

 private:
  KeyframeId add_keyframe(Map& map, const FrameTracking& tracking) const;

  PinholeCamera camera_;
  SlamOptions options_;
  KeyframeId last_keyframe_;
  int frames_since_keyframe_ = 0;
};

}  // namespace kinloop
