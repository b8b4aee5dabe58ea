#pragma once
// In: the edges of some frames. Out: how depth lies to colour, by the mapping of depth borders that best
// meets colour edges: registered, mirrored, flipped, of another scale or shifted.

#include <optional>
#include <span>

#include <Eigen/Core>

#include "session/input/measures/edge_sample.hpp"

namespace kinloop {

/// Maps pixels of the depth image to those of colour: p - middle -> scale * (p - middle) + shift.
struct DepthMapping {
  Eigen::Vector2d scale = {1, 1};  ///< negative where mirrored
  Eigen::Vector2d shift = {0, 0};  ///< as a share of the larger side of the image

  [[nodiscard]] bool is_mirrored() const { return scale.x() < 0 || scale.y() < 0; }
};

/// How well depth borders meet colour edges, in standard deviations over shifts that mean nothing.
struct EdgeAlignment {
  DepthMapping best;
  double best_score = 0;
  double registered_score = 0;  ///< of the depth image as it is, shifted by hardly more than motion explains
  double other_score = 0;       ///< of the best mapping unlike `best` and unlike the depth image as it is
};

/// Which mappings are tried: all, or only the image as it is and mirrored, at a thirtieth of the time.
enum class AlignmentSearch { kMirrored, kAll };

/// Returns nullopt if there are too few borders.
std::optional<EdgeAlignment> align_edges(std::span<const EdgeSample> samples, AlignmentSearch search);

}  // namespace kinloop
