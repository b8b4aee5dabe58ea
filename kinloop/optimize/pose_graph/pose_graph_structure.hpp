#pragma once
// In: a pose graph. Out: what follows from which vertex is connected to which, alone.

#include <vector>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {

/// The connected part of each vertex, numbered from 0 in the order of their first vertices.
template <class Pose>
std::vector<size_t> connected_components(const BasicPoseGraph<Pose>& graph);

/// Which vertices do not move: those fixed, and the first of every part without a fixed vertex or a prior.
template <class Pose>
std::vector<bool> fixed_vertices(const BasicPoseGraph<Pose>& graph);

/// The poses with those of the unknown vertices chained along edges, breadth first, from the `known`
/// vertices; the last of these come first, since a path goes on where it ended.
template <class Pose>
std::vector<Pose> propagate_poses(const BasicPoseGraph<Pose>& graph, std::vector<Pose> T_world_vertex,
                                  const std::vector<uint32_t>& known);

}  // namespace kinloop
