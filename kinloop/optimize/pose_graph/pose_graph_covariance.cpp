#include "kinloop/core/errors.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_structure.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_system.hpp"

namespace kinloop {

template <class Pose>
std::optional<std::vector<typename BasicPoseGraph<Pose>::Matrix>> marginal_covariances(
    const BasicPoseGraph<Pose>& graph, std::span<const uint32_t> vertices) {
  const PoseGraphLayout layout = make_pose_graph_layout(graph, fixed_vertices(graph));
  const EliminationPlan plan = plan_elimination(layout.pattern);
  PoseGraphSystem<Pose> system(layout.pattern);
  linearize(graph, layout, PoseGraphKernel{}, graph.T_world_vertex, system);
  SparseCholesky<Pose::kDof> cholesky(plan);
  if (!cholesky.factorize(system.H)) return {};

  const auto of_block = cholesky.inverse_diagonal();
  std::vector<typename BasicPoseGraph<Pose>::Matrix> covariances;
  for (const uint32_t vertex : vertices) {
    require(vertex < layout.block_of_vertex.size(), "pose graph: covariance requested for an unknown vertex");
    const uint32_t block = layout.block_of_vertex[vertex];
    covariances.emplace_back(BasicPoseGraph<Pose>::Matrix::Zero());
    if (block != kNoBlock) covariances.back() = of_block[block];
  }
  return covariances;
}

template std::optional<std::vector<PoseGraph::Matrix>> marginal_covariances(const PoseGraph&,
                                                                            std::span<const uint32_t>);
template std::optional<std::vector<PoseGraph2d::Matrix>> marginal_covariances(const PoseGraph2d&,
                                                                              std::span<const uint32_t>);

}  // namespace kinloop
