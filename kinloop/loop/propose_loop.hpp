#pragma once
// Proposes a loop between two keyframes: the cheap stages of verification, which need no landmarks. Most
// wrong candidates end here.

#include <optional>
#include <vector>

#include "kinloop/loop/drift.hpp"
#include "kinloop/loop/options.hpp"
#include "kinloop/place/vocabulary.hpp"

namespace kinloop {

/// The keypoints of a keyframe and their nodes of the vocabulary.
struct IndexedView {
  const Features& features;
  const std::vector<NodeId>& nodes;
};

/// An old keyframe and the pose of the new one relative to it, to be verified.
struct ProposedLoop {
  KeyframeId reference;
  SE3 T_reference_camera;
  std::optional<PredictedView> predicted;  ///< nullopt between components
};

/// Two keyframes that may show one place.
struct ViewPair {
  IndexedView reference, camera;
  const std::optional<PredictedView>& predicted;  ///< of the camera relative to the reference
};

/// Estimates the pose of the camera relative to the reference from their keypoints alone: matching by
/// vocabulary nodes, matches against `predicted` dropped, P3P with RANSAC. nullopt if too few agree.
std::optional<SE3> propose_pose(const ViewPair& views, const Sensor& sensor, const TrackingOptions& options,
                                uint64_t seed);

}  // namespace kinloop
