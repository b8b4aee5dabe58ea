#pragma once
// A loop closure: two keyframes that show the same place, from the first guess to an edge of the map.

#include "kinloop/core/ids.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// How far a loop closure has been checked.
enum class LoopStage {
  kHypothesis,   ///< the views look alike; the pose comes from matched keypoints alone
  kVerified,     ///< landmarks, depth and appearance agree with the pose
  kProvisional,  ///< waits for other keyframes to agree; does not correct the map yet
  kAccepted,     ///< an edge of the map
  kWithdrawn,    ///< was accepted or provisional and has been refuted
};

/// The support for a loop closure.
struct LoopEvidence {
  int inliers = 0;            ///< landmarks around `a` that `b` observes, consistently with T_a_b
  int visible_landmarks = 0;  ///< landmarks around `a` in the view of `b`; 0 if read from a file
};

/// A measured relative pose of two keyframes of the same place.
struct LoopClosure {
  KeyframeId a;  ///< the place, usually the older keyframe
  KeyframeId b;
  SE3 T_a_b;
  /// Information matrix of (translation; quaternion vector part) as in pose_graph.hpp, 1/m^2 and 1; not set
  /// for a hypothesis.
  Matrix6d information = Matrix6d::Identity();
  LoopEvidence evidence = {};
  LoopStage stage = LoopStage::kHypothesis;
};

}  // namespace kinloop
