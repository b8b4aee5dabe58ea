#pragma once
// Connectivity of a pose graph.

#include <vector>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {

/// Returns the connected component of each vertex, numbered from 0 in order of their first vertices.
template <class Pose>
std::vector<size_t> connected_components(const BasicPoseGraph<Pose>& graph);

/// Returns which vertices are constant: the fixed ones, and the first of every component without a fixed
/// vertex or a prior.
template <class Pose>
std::vector<bool> fixed_vertices(const BasicPoseGraph<Pose>& graph);

/// Returns the poses with unknown vertices chained breadth-first along edges from the `known` ones. Starts
/// from the last known vertices, since a path continues where it ended.
template <class Pose>
std::vector<Pose> propagate_poses(const BasicPoseGraph<Pose>& graph, std::vector<Pose> T_world_vertex,
                                  const std::vector<uint32_t>& known);

}  // namespace kinloop
