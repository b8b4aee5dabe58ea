#pragma once
// In: a solved pose graph. Out: how well it determines chosen poses.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kinloop/optimize/pose_graph/pose_graph.hpp"

namespace kinloop {

/// Covariance of each vertex's tangent vector d in T_world_vertex * (d_translation; exp(d_rotation)), that is
/// in the vertex's own frame, with all other vertices unknown and the held ones exact (zero for these).
/// Nothing where the measurements do not determine all poses.
template <class Pose>
std::optional<std::vector<typename BasicPoseGraph<Pose>::Matrix>> marginal_covariances(
    const BasicPoseGraph<Pose>& graph, std::span<const uint32_t> vertices);

}  // namespace kinloop
