#pragma once

#include <memory>
#include <vector>

#include "kinloop/base/ids.hpp"
#include "kinloop/features/features.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// A frame that the map keeps. `landmark_of` has one entry per keypoint; an invalid id where it shows no
/// landmark.
struct Keyframe {
  KeyframeId id;
  FrameId frame;
  int64_t stamp_ns = 0;
  uint32_t component = 0;         ///< poses of different components cannot be compared
  bool begins_component = false;  ///< nothing is known of how the camera came here
  SE3 T_world_camera;
  std::shared_ptr<const Features> features;
  std::vector<LandmarkId> landmark_of;
};

/// Keypoint `feature` of `keyframe`.
struct Observation {
  KeyframeId keyframe;
  uint32_t feature = 0;

  auto operator<=>(const Observation&) const = default;  // NOLINT(modernize-use-nullptr): as in ids.hpp
};

/// A point of the map, fixed to the keyframe that first saw it: it follows when that keyframe is corrected.
struct Landmark {
  LandmarkId id;
  KeyframeId anchor;
  Eigen::Vector3d p_anchor = Eigen::Vector3d::Zero();  ///< in the anchor's camera frame, m
  std::vector<Observation> observations;               ///< in the order they were made
};

/// Two keyframes far apart in time, found to show the same place.
struct LoopEdge {
  KeyframeId a;
  KeyframeId b;
  SE3 T_a_b;
  Matrix6d information = Matrix6d::Identity();  ///< of (translation; rotation), per m^2 and rad^2
  int inliers = 0;
};

}  // namespace kinloop
