#pragma once
// Chordal initialization of a pose graph, which needs no starting values: solves for all rotation matrices by
// linear least squares and projects each to the nearest rotation (Martinec and Pajdla 2007; Carlone et al.
// 2015), then solves for the translations, which are linear for given rotations.

#include <optional>
#include <vector>

#include "kinloop/optimize/pose_graph/solvers/pose_graph_system.hpp"

namespace kinloop {

/// Returns the initial poses; fixed vertices keep theirs. nullopt if the measurements do not determine all
/// poses.
template <class Pose>
std::optional<std::vector<Pose>> chordal_initialization(const BasicPoseGraph<Pose>& graph,
                                                        const PoseGraphLayout& layout,
                                                        const EliminationPlan& plan);

}  // namespace kinloop
