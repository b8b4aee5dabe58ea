#pragma once
// Evidence for a loop closure in the finished map: the two keyframes around it with the most shared
// landmarks, and the landmarks of one reprojected into the image of the other.

#include <optional>
#include <vector>

#include "kinloop/map/map.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Two keyframes of one place, far apart in time.
struct KeyframePair {
  KeyframeId older, newer;
  int shared = 0;  ///< common landmarks
};

/// Returns the pair that shares the most landmarks among the ends of the loop and their covisible keyframes.
/// Each keyframe stays on its side of the loop: within a third of its length from its end.
KeyframePair most_overlapping_pair(const Map& map, const LoopClosure& loop);

/// Sensor and motion of a keyframe.
struct MovingSensor {
  Sensor sensor;
  Velocity velocity;  ///< at the keyframe's stamp
};

/// A landmark observed in one keyframe, projected into another.
struct ReprojectedLandmark {
  Eigen::Vector2d observed;                           ///< keypoint of the first keyframe, raw px
  Eigen::Vector2d predicted;                          ///< in the second image, raw px
  double depth_m = 0;                                 ///< z in the second camera
  std::optional<Eigen::Vector2d> observed_in_second;  ///< keypoint of the second keyframe, raw px
};

/// Projects the landmarks of `from` into the image of `into`, given the poses of the map and the motion of
/// the second camera during its readout.
std::vector<ReprojectedLandmark> reproject_landmarks(const Map& map, KeyframeId from, KeyframeId into,
                                                     const MovingSensor& moving);

}  // namespace kinloop
