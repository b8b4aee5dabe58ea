#pragma once
// In: a pose graph. Out: poses to start from that need no starting values: all rotations at once from a
// linear least squares problem on their matrix entries, each then replaced by the nearest rotation (Martinec
// and Pajdla 2007; Carlone et al. 2015), and after them all translations, which are linear once rotations are
// known.

#include <optional>
#include <vector>

#include "kinloop/optimize/pose_graph/pose_graph_system.hpp"

namespace kinloop {

/// Nothing where the measurements do not determine all poses. Held vertices stay.
template <class Pose>
std::optional<std::vector<Pose>> chordal_initialization(const BasicPoseGraph<Pose>& graph,
                                                        const PoseGraphLayout& layout,
                                                        const EliminationPlan& plan);

}  // namespace kinloop
