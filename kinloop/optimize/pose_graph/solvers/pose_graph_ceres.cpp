// Pose graph optimization with Ceres and analytic Jacobians.

#include <array>

#include <Eigen/Eigenvalues>
#include <ceres/ceres.h>
#include <ceres/version.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/optimize/pose_graph/pose_graph_error.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_kernel.hpp"
#include "kinloop/optimize/pose_graph/solvers/pose_graph_solvers.hpp"

namespace kinloop {
namespace {

/// A pose as a Ceres parameter block.
template <class Pose>
struct Packed;

template <>
struct Packed<SE3> {
  static constexpr int kSize = 7;
  static SE3 unpack(const double* x) { return {{x[6], x[3], x[4], x[5]}, {x[0], x[1], x[2]}}; }
  static std::array<double, kSize> pack(const SE3& T) {
    return {T.translation.x(), T.translation.y(), T.translation.z(), T.rotation.x(),
            T.rotation.y(),    T.rotation.z(),    T.rotation.w()};
  }
};

template <>
struct Packed<SE2> {
  static constexpr int kSize = 3;
  static SE2 unpack(const double* x) { return {{x[0], x[1]}, x[2]}; }
  static std::array<double, kSize> pack(const SE2& T) {
    return {T.translation.x(), T.translation.y(), T.angle_rad};
  }
};

/// The Jacobian with respect to the packed pose holds that with respect to the tangent vector in its first
/// columns, followed by zeros. The Jacobian of `Plus` selects these columns, since Ceres uses only the
/// product.
template <class Pose>
using PickTangent = Eigen::Matrix<double, Packed<Pose>::kSize, Pose::kDof, Eigen::RowMajor>;

template <class Pose>
bool plus_packed(const double* x, const double* d, double* x_plus_d) {
  const auto packed =
      Packed<Pose>::pack(retract(Packed<Pose>::unpack(x), typename BasicPoseGraph<Pose>::Vector(d)));
  std::copy(packed.begin(), packed.end(), x_plus_d);
  return true;
}

// Ceres 2.1 (Debian 12) renamed local parameterizations to manifolds; Ubuntu 22.04 has 2.0.
#if CERES_VERSION_MAJOR > 2 || (CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR >= 1)
template <class Pose>
class PoseManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return Packed<Pose>::kSize; }
  int TangentSize() const override { return Pose::kDof; }
  bool Plus(const double* x, const double* d, double* x_plus_d) const override {
    return plus_packed<Pose>(x, d, x_plus_d);
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<PickTangent<Pose>>(jacobian).setIdentity();
    return true;
  }
  // Not needed by the solver.
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }
};

template <class Pose>
void set_manifold(ceres::Problem& problem, double* block) {
  problem.SetManifold(block, new PoseManifold<Pose>);  // the problem owns it
}
#else
template <class Pose>
class PoseManifold : public ceres::LocalParameterization {
 public:
  int GlobalSize() const override { return Packed<Pose>::kSize; }
  int LocalSize() const override { return Pose::kDof; }
  bool Plus(const double* x, const double* d, double* x_plus_d) const override {
    return plus_packed<Pose>(x, d, x_plus_d);
  }
  bool ComputeJacobian(const double*, double* jacobian) const override {
    Eigen::Map<PickTangent<Pose>>(jacobian).setIdentity();
    return true;
  }
};

template <class Pose>
void set_manifold(ceres::Problem& problem, double* block) {
  problem.SetParameterization(block, new PoseManifold<Pose>);
}
#endif

/// Returns S with S' S = information; the information may be singular.
template <class Matrix>
Matrix square_root(const Matrix& information) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(information);
  return eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

/// The whitened error S e of one edge; a prior has only vertex b.
template <class Pose>
class EdgeCost : public ceres::CostFunction {
 public:
  explicit EdgeCost(const typename BasicPoseGraph<Pose>::Edge& edge)
      : T_a_b_(edge.T_a_b), root_(square_root(edge.information)), prior_(edge.a == kWorld) {
    set_num_residuals(Pose::kDof);
    mutable_parameter_block_sizes()->assign(prior_ ? 1 : 2, Packed<Pose>::kSize);
  }

  bool Evaluate(double const* const* poses, double* residuals, double** jacobians) const override {
    const Pose T_world_a = prior_ ? Pose{} : Packed<Pose>::unpack(poses[0]);
    const Pose T_world_b = Packed<Pose>::unpack(poses[prior_ ? 0 : 1]);
    const auto linear = linearize_edge(T_world_a, T_world_b, T_a_b_);
    Eigen::Map<typename BasicPoseGraph<Pose>::Vector> residual(residuals);
    residual = root_ * linear.e;
    if (jacobians == nullptr) return true;
    if (!prior_) write(jacobians[0], linear.de_da);
    write(jacobians[prior_ ? 0 : 1], linear.de_db);
    return true;
  }

 private:
  using Matrix = typename BasicPoseGraph<Pose>::Matrix;

  void write(double* jacobian, const Matrix& derivative) const {
    if (jacobian == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, Pose::kDof, Packed<Pose>::kSize, Eigen::RowMajor>> map(jacobian);
    map.setZero();
    map.template leftCols<Pose::kDof>() = root_ * derivative;
  }

  Pose T_a_b_;
  Matrix root_;
  bool prior_;
};

/// The shared kernel as a Ceres loss, without second derivative, so that it reweights like the other solvers.
class KernelLoss : public ceres::LossFunction {
 public:
  explicit KernelLoss(const PoseGraphKernel& kernel) : kernel_(kernel) {}
  void Evaluate(double squared, double rho[3]) const override {
    rho[0] = kernel_.rho(squared);
    rho[1] = kernel_.weight(squared);
    rho[2] = 0;
  }

 private:
  PoseGraphKernel kernel_;
};

ceres::Solver::Options ceres_options(const PoseGraphOptions& options) {
  if (options.method == PoseGraphMethod::kGaussNewton) {
    throw UsageError("solver ceres does not support method gauss-newton; use levenberg or dogleg");
  }
  ceres::Solver::Options ceres_options;
  ceres_options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  ceres_options.trust_region_strategy_type =
      options.method == PoseGraphMethod::kDogleg ? ceres::DOGLEG : ceres::LEVENBERG_MARQUARDT;
  ceres_options.max_num_iterations = options.max_iterations;
  ceres_options.function_tolerance = kCostTolerance;
  ceres_options.gradient_tolerance = 0;  // depends on units, unlike the relative decrease of the cost
  ceres_options.parameter_tolerance = 0;
  ceres_options.num_threads = 1;  // fixed summation order: identical results in every run
  ceres_options.logging_type = ceres::SILENT;
  return ceres_options;
}

}  // namespace

template <class Pose>
SolvedPoses<Pose> solve_with_ceres(const BasicPoseGraph<Pose>& graph, const std::vector<bool>& held,
                                   const PoseGraphOptions& options) {
  const ceres::Solver::Options solver_options = ceres_options(options);
  std::vector<std::array<double, Packed<Pose>::kSize>> poses;
  for (const Pose& T : graph.T_world_vertex) poses.push_back(Packed<Pose>::pack(T));

  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  KernelLoss loss(PoseGraphKernel{options.robust_kernel, options.robust_width});
  for (size_t vertex = 0; vertex < poses.size(); ++vertex) {
    problem.AddParameterBlock(poses[vertex].data(), Packed<Pose>::kSize);
    set_manifold<Pose>(problem, poses[vertex].data());
    if (held[vertex]) problem.SetParameterBlockConstant(poses[vertex].data());
  }
  for (const auto& edge : graph.edges) {
    std::vector<double*> blocks;
    if (edge.a != kWorld) blocks.push_back(poses[edge.a].data());
    blocks.push_back(poses[edge.b].data());
    problem.AddResidualBlock(new EdgeCost<Pose>(edge), edge.is_odometry ? nullptr : &loss, blocks);
  }
  const Stopwatch stopwatch;
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options, &problem, &summary);

  SolvedPoses<Pose> solved;
  solved.seconds = stopwatch.wall_s();
  solved.iterations = static_cast<int>(summary.iterations.size()) - 1;
  solved.converged = summary.termination_type == ceres::CONVERGENCE;
  for (const auto& pose : poses) solved.T_world_vertex.push_back(Packed<Pose>::unpack(pose.data()));
  return solved;
}

template SolvedPoses<SE3> solve_with_ceres(const PoseGraph&, const std::vector<bool>&,
                                           const PoseGraphOptions&);
template SolvedPoses<SE2> solve_with_ceres(const PoseGraph2d&, const std::vector<bool>&,
                                           const PoseGraphOptions&);

}  // namespace kinloop
