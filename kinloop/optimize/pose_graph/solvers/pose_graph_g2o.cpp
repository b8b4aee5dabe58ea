// Pose graph optimization with g2o (Kuemmerle et al. 2011), if installed.
#ifdef KINLOOP_WITH_G2O

#include <memory>
#include <type_traits>
#include <utility>

#include <g2o/core/block_solver.h>
#include <g2o/core/optimization_algorithm_dogleg.h>
#include <g2o/core/optimization_algorithm_gauss_newton.h>
#include <g2o/core/optimization_algorithm_levenberg.h>
#include <g2o/core/robust_kernel.h>
#include <g2o/core/sparse_optimizer.h>
#include <g2o/core/sparse_optimizer_terminate_action.h>
#include <g2o/types/slam2d/edge_se2.h>
#include <g2o/types/slam2d/vertex_se2.h>
#include <g2o/types/slam3d/edge_se3.h>
#include <g2o/types/slam3d/vertex_se3.h>
#ifdef KINLOOP_G2O_HAS_CHOLMOD
#include <g2o/solvers/cholmod/linear_solver_cholmod.h>
#else
#include <g2o/solvers/eigen/linear_solver_eigen.h>
#endif

#include "kinloop/core/errors.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_kernel.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_solvers.hpp"

namespace kinloop {
namespace {

/// g2o types of pose, vertex and edge.
template <class Pose>
struct G2oTypes;

template <>
struct G2oTypes<SE3> {
  using Vertex = g2o::VertexSE3;
  using Edge = g2o::EdgeSE3;
  static g2o::Isometry3 to_g2o(const SE3& T) { return g2o::Isometry3(T.matrix()); }
  static SE3 from_g2o(const g2o::Isometry3& T) {
    return {Eigen::Quaterniond(T.linear()).normalized(), T.translation()};
  }
};

template <>
struct G2oTypes<SE2> {
  using Vertex = g2o::VertexSE2;
  using Edge = g2o::EdgeSE2;
  static g2o::SE2 to_g2o(const SE2& T) { return {T.translation.x(), T.translation.y(), T.angle_rad}; }
  static SE2 from_g2o(const g2o::SE2& T) { return {T.translation(), T.rotation().angle()}; }
};

#ifdef KINLOOP_G2O_HAS_CHOLMOD
template <class Matrix>
using LinearSolver = g2o::LinearSolverCholmod<Matrix>;
#else
template <class Matrix>
using LinearSolver = g2o::LinearSolverEigen<Matrix>;
#endif

/// From version 2 on, g2o holds what it is given by shared pointers; before, by plain ones.
constexpr bool kSharedPointers =
    !std::is_pointer_v<decltype(std::declval<g2o::SparseOptimizer&>().vertex(0))>;

/// For a setter of g2o that takes ownership.
template <class Object>
auto given(std::unique_ptr<Object> object) {
  if constexpr (kSharedPointers) {
    return std::shared_ptr<Object>(std::move(object));
  } else {
    return object.release();
  }
}

/// For a setter of g2o that took no ownership before version 2.
template <class Object>
auto lent(const std::shared_ptr<Object>& object) {
  if constexpr (kSharedPointers) {
    return object;
  } else {
    return object.get();
  }
}

/// The shared kernel as a g2o kernel.
class G2oKernel : public g2o::RobustKernel {
 public:
  explicit G2oKernel(const PoseGraphKernel& kernel) : kernel_(kernel) {}
  void robustify(double squared, g2o::Vector3& rho) const override {
    rho = {kernel_.rho(squared), kernel_.weight(squared), 0};
  }

 private:
  PoseGraphKernel kernel_;
};

template <class Pose>
std::unique_ptr<g2o::OptimizationAlgorithm> make_algorithm(PoseGraphMethod method) {
  using BlockSolver = g2o::BlockSolver<g2o::BlockSolverTraits<Pose::kDof, Pose::kDof>>;
  auto linear_solver = std::make_unique<LinearSolver<typename BlockSolver::PoseMatrixType>>();
  // Otherwise g2o writes a matrix that is not positive definite to ./debug.txt.
  linear_solver->setWriteDebug(false);
  auto blocks = std::make_unique<BlockSolver>(std::move(linear_solver));
  if (method == PoseGraphMethod::kGaussNewton) {
    return std::make_unique<g2o::OptimizationAlgorithmGaussNewton>(std::move(blocks));
  }
  if (method == PoseGraphMethod::kDogleg)
    return std::make_unique<g2o::OptimizationAlgorithmDogleg>(std::move(blocks));
  return std::make_unique<g2o::OptimizationAlgorithmLevenberg>(std::move(blocks));
}

/// Copies the graph into the optimiser. A prior becomes an edge from an additional fixed vertex at the
/// origin. The optimiser owns vertices, edges and kernels.
template <class Pose>
void fill(g2o::SparseOptimizer& optimizer, const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held,
          const PoseGraphKernel& kernel) {
  using Types = G2oTypes<Pose>;
  const size_t count = graph.T_world_vertex.size();
  for (size_t id = 0; id <= count; ++id) {
    auto vertex = std::make_unique<typename Types::Vertex>();
    vertex->setId(static_cast<int>(id));
    vertex->setEstimate(Types::to_g2o(id < count ? graph.T_world_vertex[id] : Pose{}));
    vertex->setFixed(id == count || held[id]);
    optimizer.addVertex(given(std::move(vertex)));
  }
  for (const auto& edge : graph.edges) {
    auto g2o_edge = std::make_unique<typename Types::Edge>();
    g2o_edge->setVertex(0, optimizer.vertex(static_cast<int>(edge.a == kWorld ? count : edge.a)));
    g2o_edge->setVertex(1, optimizer.vertex(static_cast<int>(edge.b)));
    g2o_edge->setMeasurement(Types::to_g2o(edge.T_a_b));
    g2o_edge->setInformation(edge.information);
    if (kernel.kind != RobustKernel::kNone && !edge.is_odometry) {
      g2o_edge->setRobustKernel(given(std::make_unique<G2oKernel>(kernel)));
    }
    optimizer.addEdge(given(std::move(g2o_edge)));
  }
}

}  // namespace

template <class Pose>
SolvedPoses<Pose> solve_with_g2o(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held,
                                 const PoseGraphOptions& options) {
  g2o::SparseOptimizer optimizer;  // owns the algorithm
  optimizer.setAlgorithm(given(make_algorithm<Pose>(options.method)));
  fill(optimizer, graph, held, PoseGraphKernel{options.robust_kernel, options.robust_width});
  const auto stop_when_flat = std::make_shared<g2o::SparseOptimizerTerminateAction>();
  stop_when_flat->setGainThreshold(kCostTolerance);
  optimizer.addPostIterationAction(lent(stop_when_flat));

  const Stopwatch stopwatch;
  optimizer.initializeOptimization();
  const int iterations = optimizer.optimize(options.max_iterations);

  SolvedPoses<Pose> solved;
  solved.seconds = stopwatch.wall_s();
  solved.iterations = std::max(0, iterations);
  solved.converged = iterations > 0 && iterations < options.max_iterations;
  for (size_t id = 0; id < graph.T_world_vertex.size(); ++id) {
    const auto vertex = optimizer.vertex(static_cast<int>(id));
    const auto& pose = static_cast<const typename G2oTypes<Pose>::Vertex&>(*vertex);
    solved.T_world_vertex.push_back(G2oTypes<Pose>::from_g2o(pose.estimate()));
  }
  return solved;
}

template SolvedPoses<SE3> solve_with_g2o(const PoseGraph&, const std::vector<bool>&, const PoseGraphOptions&);
template SolvedPoses<SE2> solve_with_g2o(const PoseGraph2d&, const std::vector<bool>&,
                                         const PoseGraphOptions&);

}  // namespace kinloop

#endif
