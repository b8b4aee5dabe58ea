#pragma once
// The sparse linear system of a step of the pose graph, H d = -g with H = sum J' w Omega J and g = sum J' w
// Omega e, where w is the weight of the robust kernel.

#include <limits>
#include <vector>

#include "kinloop/optimize/linear/sparse_cholesky.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_kernel.hpp"

namespace kinloop {

/// Marks fixed vertices, and edges that do not join two free vertices.
inline constexpr uint32_t kNoBlock = std::numeric_limits<uint32_t>::max();

/// Positions of vertices and edges in the system.
struct PoseGraphLayout {
  std::vector<uint32_t> block_of_vertex;
  std::vector<uint32_t> slot_of_edge;  ///< in pattern.off_diagonal
  BlockPattern pattern;
};

template <class Pose>
PoseGraphLayout make_pose_graph_layout(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held);

template <class Pose>
struct PoseGraphSystem {
  BlockMatrix<Pose::kDof> H;
  Eigen::VectorXd minus_g;

  explicit PoseGraphSystem(const BlockPattern& pattern);
};

/// Returns the system at `T_world_vertex`.
template <class Pose>
void linearize(const BasicPoseGraph<Pose>& graph, const PoseGraphLayout& layout,
               const PoseGraphKernel& kernel, const std::vector<Pose>& T_world_vertex,
               PoseGraphSystem<Pose>& system);

/// Returns the sum of rho(e' Omega e) over edges.
template <class Pose>
double robust_cost(const BasicPoseGraph<Pose>& graph, const PoseGraphKernel& kernel,
                   const std::vector<Pose>& T_world_vertex);

/// Returns the poses updated by the step `d` of the system.
template <class Pose>
std::vector<Pose> apply_step(const std::vector<Pose>& T_world_vertex, const PoseGraphLayout& layout,
                             const Eigen::VectorXd& d);

}  // namespace kinloop
