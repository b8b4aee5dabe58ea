#pragma once
// Decides which located frames become keyframes, and adds those to the map with their landmarks.

#include "kinloop/slam/options.hpp"
#include "kinloop/slam/tracker.hpp"

namespace kinloop {

class Mapper {
 public:
  Mapper(const PinholeCamera& camera, const SlamOptions& options) : camera_(camera), options_(options) {}

  /// Continues after `newest`, a keyframe of a loaded map.
  void continue_from(KeyframeId newest) { last_keyframe_ = newest; }

  /// Returns whether a frame should become a keyframe: true if it starts a map, or if it is located and shows
  /// enough new content. Call once per frame, in order.
  [[nodiscard]] bool needs_keyframe(const Map& map, const FrameTracking& tracking);

  /// Adds the frame to the map: its keyframe, observations and new landmarks. Culls bad landmarks.
  KeyframeId insert_keyframe(Map& map, const FrameTracking& tracking);

 private:
  KeyframeId add_keyframe(Map& map, const FrameTracking& tracking) const;

  PinholeCamera camera_;
  SlamOptions options_;
  KeyframeId last_keyframe_;
  int frames_since_keyframe_ = 0;
};

}  // namespace kinloop
