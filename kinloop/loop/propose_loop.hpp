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

/// Estimates the pose of `camera_view` relative to `reference_view` from their keypoints alone: matching by
/// vocabulary nodes, matches against `predicted` dropped, P3P with RANSAC. nullopt if too few agree.
std::optional<SE3> propose_pose(const IndexedView& reference_view, const IndexedView& camera_view,
                                const std::optional<PredictedView>& predicted, const PinholeCamera& camera,
                                const PnpRansacOptions& options, uint64_t seed);

}  // namespace kinloop
