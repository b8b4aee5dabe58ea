#pragma once
// Marginal covariances of the poses of a solved pose graph.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {

/// Returns the marginal covariance of each vertex's tangent vector d in T_world_vertex * (d_translation;
/// exp(d_rotation)), i.e. in the vertex's own frame, given exact fixed vertices (zero for these). nullopt if
/// the measurements do not determine all poses.
template <class Pose>
std::optional<std::vector<typename BasicPoseGraph<Pose>::Matrix>> marginal_covariances(
    const BasicPoseGraph<Pose>& graph, std::span<const uint32_t> vertices);

}  // namespace kinloop
