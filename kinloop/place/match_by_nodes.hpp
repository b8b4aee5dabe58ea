#pragma once
// Guided matching by vocabulary (the direct index of Galvez-Lopez and Tardos 2012): only keypoints under the
// same node of the vocabulary tree are compared, a small part of all pairs.

#include <span>
#include <vector>

#include "kinloop/features/matcher.hpp"
#include "kinloop/place/vocabulary/vocabulary.hpp"

namespace kinloop {

/// Keypoints of an image with their nodes (`Vocabulary::quantize`).
struct IndexedDescriptors {
  const cv::Mat& descriptors;     ///< N x 32 of 8UC1
  std::span<const NodeId> nodes;  ///< one per row
};

struct NodeMatchOptions {
  int max_distance = 64;   ///< bits
  double max_ratio = 0.9;  ///< best to second-best distance
};

/// Matches keypoints that are mutual nearest neighbours within a node and distinct from the second nearest.
/// In ascending order of `a`.
std::vector<Match> match_by_nodes(const IndexedDescriptors& a, const IndexedDescriptors& b,
                                  const NodeMatchOptions& options);

}  // namespace kinloop
