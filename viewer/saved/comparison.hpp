#pragma once
// In: two maps of one place in one frame, and what differs between them. Out: a scene of both.

#include <string>

#include "kinloop/geometry/trajectory.hpp"
#include "tools/map_difference/map_difference.hpp"
#include "viewer/scene/scene.hpp"

namespace kinloop {

/// One of the two maps.
struct ComparedVisit {
  std::string name;
  Trajectory path, keyframes;  ///< in the common world
  ColoredCloud cloud;
  std::vector<TimelineFrame> timeline;  ///< its keyframes are indices into `keyframes`
};

struct Comparison {
  ComparedVisit before, after;
  MapDifference difference;
  /// Pairs of keyframes that loops connect: indices into those of `before`, followed by those of `after`.
  std::vector<std::pair<KeyframeId, KeyframeId>> loops;
  size_t loops_between = 0;  ///< of them, those that align the two
  Eigen::Vector3d up = {0, -1, 0};
  Eigen::Quaterniond R_file_world = Eigen::Quaterniond::Identity();  ///< of the listed positions
  Eigen::Vector2d half_size_at_1m = {0.6, 0.45};                     ///< of the image
};

/// Which points of the two clouds are shown together.
enum class DifferenceLayer { kRestBefore, kRestAfter, kGone, kAdded, kMoved };

/// Returns the points of a layer in its colours.
ColoredCloud layer_of(const Comparison& comparison, DifferenceLayer layer);

/// Fills the scene with it.
void show_comparison(Scene& scene, const Comparison& comparison);

}  // namespace kinloop
