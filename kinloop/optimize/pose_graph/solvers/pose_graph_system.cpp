#include "kinloop/optimize/pose_graph/solvers/pose_graph_system.hpp"

#include <algorithm>

#include "kinloop/optimize/pose_graph/pose_graph_error.hpp"

namespace kinloop {

template <class Pose>
PoseGraphLayout make_pose_graph_layout(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held) {
  PoseGraphLayout layout;
  layout.block_of_vertex.assign(held.size(), kNoBlock);
  for (size_t vertex = 0; vertex < held.size(); ++vertex) {
    if (!held[vertex]) layout.block_of_vertex[vertex] = layout.pattern.size++;
  }
  const auto pair_of = [&](const auto& edge) {
    const uint32_t a = edge.a == kWorld ? kNoBlock : layout.block_of_vertex[edge.a];
    const uint32_t b = layout.block_of_vertex[edge.b];
    return std::pair(std::max(a, b), std::min(a, b));
  };
  auto& pairs = layout.pattern.off_diagonal;
  for (const auto& edge : graph.edges) {
    if (pair_of(edge).first != kNoBlock) pairs.push_back(pair_of(edge));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (const auto& edge : graph.edges) {
    const auto pair = pair_of(edge);
    const auto found = std::lower_bound(pairs.begin(), pairs.end(), pair);
    layout.slot_of_edge.push_back(pair.first == kNoBlock ? kNoBlock
                                                         : static_cast<uint32_t>(found - pairs.begin()));
  }
  return layout;
}

template <class Pose>
PoseGraphSystem<Pose>::PoseGraphSystem(const BlockPattern& pattern)
    : H(pattern), minus_g(Eigen::VectorXd::Zero(Pose::kDof * static_cast<Eigen::Index>(pattern.size))) {}

template <class Pose>
void linearize(const BasicPoseGraph<Pose>& graph, const PoseGraphLayout& layout,
               const PoseGraphKernel& kernel, const std::vector<Pose>& T_world_vertex,
               PoseGraphSystem<Pose>& system) {
  constexpr int kDof = Pose::kDof;
  using Matrix = typename BasicPoseGraph<Pose>::Matrix;
  using Vector = typename BasicPoseGraph<Pose>::Vector;
  system.H.set_zero();
  system.minus_g.setZero();
  for (size_t i = 0; i < graph.edges.size(); ++i) {
    const auto& edge = graph.edges[i];
    const uint32_t a = edge.a == kWorld ? kNoBlock : layout.block_of_vertex[edge.a];
    const uint32_t b = layout.block_of_vertex[edge.b];
    if (a == kNoBlock && b == kNoBlock) continue;
    const auto linear = linearize_edge(pose_of_a(T_world_vertex, edge), T_world_vertex[edge.b], edge.T_a_b);
    const Vector omega_e = edge.information * linear.e;
    const double weight = edge.is_odometry ? 1 : kernel.weight(linear.e.dot(omega_e));
    const Matrix omega_b = weight * (edge.information * linear.de_db);
    if (a != kNoBlock) {
      const Matrix omega_a = weight * (edge.information * linear.de_da);
      system.H.diagonal[a].noalias() += linear.de_da.transpose() * omega_a;
      system.minus_g.template segment<kDof>(kDof * a).noalias() -= omega_a.transpose() * linear.e;
    }
    if (b != kNoBlock) {
      system.H.diagonal[b].noalias() += linear.de_db.transpose() * omega_b;
      system.minus_g.template segment<kDof>(kDof * b).noalias() -= omega_b.transpose() * linear.e;
    }
    if (a == kNoBlock || b == kNoBlock) continue;
    const Matrix a_b = linear.de_da.transpose() * omega_b;
    Matrix& slot = system.H.off_diagonal[layout.slot_of_edge[i]];
    if (a > b) {
      slot += a_b;
    } else {
      slot += a_b.transpose();
    }
  }
}

template <class Pose>
double robust_cost(const BasicPoseGraph<Pose>& graph, const PoseGraphKernel& kernel,
                   const std::vector<Pose>& T_world_vertex) {
  double sum = 0;
  for (const auto& edge : graph.edges) {
    const double squared = edge_chi2(T_world_vertex, edge);
    sum += edge.is_odometry ? squared : kernel.rho(squared);
  }
  return sum;
}

template <class Pose>
std::vector<Pose> apply_step(const std::vector<Pose>& T_world_vertex, const PoseGraphLayout& layout,
                             const Eigen::VectorXd& d) {
  std::vector<Pose> result = T_world_vertex;
  for (size_t vertex = 0; vertex < result.size(); ++vertex) {
    const uint32_t block = layout.block_of_vertex[vertex];
    if (block == kNoBlock) continue;
    const typename BasicPoseGraph<Pose>::Vector own = d.segment<Pose::kDof>(Pose::kDof * block);
    result[vertex] = retract(result[vertex], own);
  }
  return result;
}

#define KINLOOP_INSTANTIATE(Pose)                                                                         \
  template PoseGraphLayout make_pose_graph_layout(const BasicPoseGraph<Pose>&, const std::vector<bool>&); \
  template struct PoseGraphSystem<Pose>;                                                                  \
  template void linearize(const BasicPoseGraph<Pose>&, const PoseGraphLayout&, const PoseGraphKernel&,    \
                          const std::vector<Pose>&, PoseGraphSystem<Pose>&);                              \
  template double robust_cost(const BasicPoseGraph<Pose>&, const PoseGraphKernel&,                        \
                              const std::vector<Pose>&);                                                  \
  template std::vector<Pose> apply_step(const std::vector<Pose>&, const PoseGraphLayout&,                 \
                                        const Eigen::VectorXd&);

KINLOOP_INSTANTIATE(SE3)
KINLOOP_INSTANTIATE(SE2)
#undef KINLOOP_INSTANTIATE

}  // namespace kinloop
