#pragma once
// In: the finished map and a loop edge. Out: what shows that the edge is true: the two keyframes around it
// with most landmarks in common, and where the landmarks of the one should appear in the image of the other.

#include <optional>
#include <vector>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/optimize/bundle/sensor_model.hpp"

namespace kinloop {

/// Two keyframes that saw one place, long after each other.
struct KeyframePair {
  KeyframeId older, newer;
  int shared = 0;  ///< landmarks that both observe
};

/// Of the keyframes covisible with either end of the loop, and the ends themselves, the pair that shares most
/// landmarks. Each stays on its side of the loop: within a third of it from its end.
KeyframePair most_overlapping_pair(const Map& map, const LoopEdge& loop);

/// How a keyframe was taken.
struct RollingShutterCamera {
  PinholeCamera camera;
  SensorVector sensor = SensorVector::Zero();  ///< how it departs from `camera`
  Velocity velocity = Velocity::Zero();        ///< at the keyframe's stamp
};

/// A landmark that one keyframe observes, in the image of another.
struct ReprojectedLandmark {
  Eigen::Vector2d observed;                           ///< keypoint of the first keyframe, raw px
  Eigen::Vector2d predicted;                          ///< in the second image, raw px
  double depth_m = 0;                                 ///< z in the second camera
  std::optional<Eigen::Vector2d> observed_in_second;  ///< keypoint of the second keyframe, raw px
};

/// The landmarks of `from` that lie in the image of `into`, by the poses of the map and by the motion of the
/// second camera while its rows were read.
std::vector<ReprojectedLandmark> reproject_landmarks(const Map& map, KeyframeId from, KeyframeId into,
                                                     const RollingShutterCamera& camera_into);

}  // namespace kinloop
