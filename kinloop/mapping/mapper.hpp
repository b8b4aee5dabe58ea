#pragma once
// Adds tracked frames to the map as keyframes, with their landmarks.

#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// What the mapper uses.
struct MapperOptions {
  LocalMapOptions local_map;
  MappingOptions mapping;
};

/// Inserts keyframes into a map.
class Mapper {
 public:
  explicit Mapper(const MapperOptions& options) : options_(options) {}

  /// Adds the frame to the map as a keyframe, with its observations and new landmarks, and culls weak
  /// landmarks. The keypoints of the frame must be matched.
  KeyframeId insert(Map& map, const TrackedFrame& tracked, const Sensor& sensor) const;

  /// Compensates the first keyframe of a map for its motion, once that is known, and moves its landmarks
  /// along. No other keyframe may observe them yet.
  void compensate_first(Map& map, KeyframeId id, const Velocity& velocity, const Sensor& sensor) const;

 private:
  void refine_observations(Map& map, KeyframeId id, const LocalMap& before, const TrackedFrame& tracked,
                           const Sensor& sensor) const;

  MapperOptions options_;
};

}  // namespace kinloop
