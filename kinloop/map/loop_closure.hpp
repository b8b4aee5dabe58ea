#pragma once
// A loop closure: two keyframes that show the same place, from the first guess to an edge of the map.

#include <limits>

#include "kinloop/core/ids.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// How far a loop closure has been checked.
enum class LoopStage {
  kHypothesis,   ///< the views look alike; the pose comes from matched keypoints alone
  kVerified,     ///< landmarks, depth and appearance agree with the pose
  kProvisional,  ///< waits for other keyframes to agree; does not correct the map yet
  kAccepted,     ///< an edge of the map
  kRejected,     ///< contradicted before it was an edge
  kWithdrawn,    ///< was an edge and has been contradicted
};

constexpr auto option_names(LoopStage) {
  using enum LoopStage;
  return std::to_array<EnumName<LoopStage>>({{kHypothesis, "hypothesis"},
                                             {kVerified, "verified"},
                                             {kProvisional, "provisional"},
                                             {kAccepted, "accepted"},
                                             {kRejected, "rejected"},
                                             {kWithdrawn, "withdrawn"}});
}

/// Why a loop closure has reached its stage.
enum class LoopReason {
  kNone,
  kKeyframesAgree,   ///< enough keyframes measure the same relative pose
  kFitsMap,          ///< the map predicts the measured pose, so that little bends
  kLoaded,           ///< an edge of a loaded map
  kTooFewKeyframes,  ///< no other keyframe, or too few, measure the same relative pose
  kAmbiguous,        ///< other keyframes, or the same, fit another place as well
  kScale,            ///< the two visits see the place in different sizes
  kDoesNotFit,       ///< odometry, the other loops or the surfaces contradict it
  kAppearance,       ///< views of the two visits that should show the same do not, or in other sizes
  kByUser,           ///< the user has taken it back
};

constexpr auto option_names(LoopReason) {
  using enum LoopReason;
  return std::to_array<EnumName<LoopReason>>({{kNone, "none"},
                                              {kKeyframesAgree, "keyframes agree"},
                                              {kFitsMap, "fits the map"},
                                              {kLoaded, "loaded"},
                                              {kTooFewKeyframes, "too few keyframes"},
                                              {kAmbiguous, "ambiguous"},
                                              {kScale, "different scale"},
                                              {kDoesNotFit, "does not fit"},
                                              {kAppearance, "looks different"},
                                              {kByUser, "by the user"}});
}

/// Size of a place in one visit relative to another, from the landmarks that both see.
struct RelativeScale {
  double factor = 1;                                       ///< of the visit of `a`, relative to that of `b`
  double sigma = std::numeric_limits<double>::infinity();  ///< standard deviation; infinite if unknown
};

/// The support for a loop closure.
struct LoopEvidence {
  int inliers = 0;            ///< landmarks around `a` that `b` observes, consistently with T_a_b
  int visible_landmarks = 0;  ///< landmarks around `a` in the view of `b`; 0 if read from a file
  RelativeScale scale = {};   ///< unknown if read from a file
};

/// The keyframes of a loop closure, which identify it.
struct LoopEnds {
  KeyframeId a, b;

  auto operator<=>(const LoopEnds&) const = default;  // NOLINT(modernize-use-nullptr): as in ids.hpp
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
  int support = 1;  ///< keyframes of the visit of `b` that measure the same relative pose, with `b`
  LoopReason reason = LoopReason::kNone;
  bool corrected = false;  ///< the map has been corrected for it

  [[nodiscard]] LoopEnds ends() const { return {a, b}; }
};

}  // namespace kinloop
