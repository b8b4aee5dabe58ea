#pragma once
// Decides which located frames become keyframes, and adds those to the map with their landmarks.

#include "kinloop/mapping/options.hpp"
#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// What the mapper uses.
struct MapperOptions {
  KeyframeOptions keyframe;
  LocalMapOptions local_map;
  MappingOptions mapping;
  bool localize_only = false;
};

class Mapper {
 public:
  explicit Mapper(const MapperOptions& options) : options_(options) {}

  /// Continues after `newest`, a keyframe of a loaded map.
  void continue_from(KeyframeId newest) { last_keyframe_ = newest; }

  /// Returns whether a frame that was tracked directly has moved far enough to become a keyframe. Whether it
  /// does depends on its keypoints.
  [[nodiscard]] bool may_need_keyframe(const Map& map, const FrameTracking& tracking);

  /// Returns whether a frame should become a keyframe: true if it starts a map, or if it is located and shows
  /// enough new content.
  [[nodiscard]] bool needs_keyframe(const Map& map, const FrameTracking& tracking) const;

  /// Adds the frame to the map: its keyframe, observations and new landmarks. Culls bad landmarks.
  KeyframeId insert_keyframe(Map& map, const FrameTracking& tracking, const Sensor& sensor);

 private:
  [[nodiscard]] int frames_since_keyframe(const Map& map, FrameId frame) const;
  KeyframeId add_keyframe(Map& map, const FrameTracking& tracking) const;
  void refine_observations(Map& map, KeyframeId id, const LocalMap& known, const FrameTracking& tracking,
                           const Sensor& sensor) const;

  MapperOptions options_;
  KeyframeId last_keyframe_;
  FrameId last_check_{0};  // the last frame for which `may_need_keyframe` was true
};

}  // namespace kinloop
