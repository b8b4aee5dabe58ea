// Bundle adjustment with Ceres: same residuals and derivatives, different solver.

#include <array>

#include <ceres/ceres.h>
#include <ceres/version.h>

#include "kinloop/geometry/robust_loss.hpp"
#include "kinloop/optimize/bundle/bundle_model.hpp"

namespace kinloop {
namespace {

constexpr int kPoseSize = 7;  // x, y, z, qx, qy, qz, qw
using PackedPose = std::array<double, kPoseSize>;
using PickTangent = Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor>;

PackedPose pack(const SE3& T) {
  return {T.translation.x(), T.translation.y(), T.translation.z(), T.rotation.x(),
          T.rotation.y(),    T.rotation.z(),    T.rotation.w()};
}

SE3 unpack(const double* x) {
  return {{x[6], x[3], x[4], x[5]}, {x[0], x[1], x[2]}};
}

bool plus_pose(const double* x, const double* d, double* x_plus_d) {
  const PackedPose packed = pack(unpack(x) * SE3::exp(Vector6d(d)));
  std::copy(packed.begin(), packed.end(), x_plus_d);
  return true;
}

// The Jacobian with respect to the packed pose holds that with respect to the tangent vector in its first six
// columns. The Jacobian of `Plus` selects these, since Ceres uses only the product. Ceres 2.1 renamed local
// parameterizations to manifolds.
#if CERES_VERSION_MAJOR > 2 || (CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR >= 1)
class PoseManifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* d, double* x_plus_d) const override {
    return plus_pose(x, d, x_plus_d);
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<PickTangent>(jacobian).setIdentity();
    return true;
  }
  // Not needed by the solver.
  bool Minus(const double*, const double*, double*) const override { return false; }
  bool MinusJacobian(const double*, double*) const override { return false; }
};
void set_manifold(ceres::Problem& problem, double* block) {
  problem.SetManifold(block, new PoseManifold);
}
#else
class PoseManifold : public ceres::LocalParameterization {
 public:
  int GlobalSize() const override { return kPoseSize; }
  int LocalSize() const override { return 6; }
  bool Plus(const double* x, const double* d, double* x_plus_d) const override {
    return plus_pose(x, d, x_plus_d);
  }
  bool ComputeJacobian(const double*, double* jacobian) const override {
    Eigen::Map<PickTangent>(jacobian).setIdentity();
    return true;
  }
};
void set_manifold(ceres::Problem& problem, double* block) {
  problem.SetParameterization(block, new PoseManifold);
}
#endif

/// Pixel or depth part of one observation; blocks: pose, point, sensor.
class ObservationCost : public ceres::CostFunction {
 public:
  ObservationCost(const BundleTask& task, size_t observation, bool depth)
      : task_(task), observation_(observation), first_row_(depth ? 2 : 0), rows_(depth ? 1 : 2) {
    set_num_residuals(rows_);
    *mutable_parameter_block_sizes() = {kPoseSize, 3, kSensorParameterCount};
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const BundleObservation& o = task_.problem.observations[observation_];
    const BundleView view(unpack(x[0]), task_.velocities[o.pose]);
    const Sensor sensor{task_.problem.sensor.camera, task_.problem.sensor.noise, SensorVector(x[2])};
    const auto linear =
        linearize_observation(sensor, o, task_.uses[observation_], view, Eigen::Vector3d(x[1]));
    if (!linear.seen) return false;  // makes Ceres take a shorter step
    Eigen::Map<Eigen::VectorXd>(residuals, rows_) = linear.e.segment(first_row_, rows_);
    if (jacobians == nullptr) return true;
    Eigen::Matrix<double, 3, kPoseSize> J_pose;
    J_pose << linear.J_pose, Eigen::Vector3d::Zero();
    write(jacobians[0], J_pose);
    write(jacobians[1], linear.J_point);
    write(jacobians[2], linear.J_sensor);
    return true;
  }

 private:
  template <class Matrix>
  void write(double* jacobian, const Matrix& derivative) const {
    constexpr int kColumns = Matrix::ColsAtCompileTime;
    if (jacobian == nullptr) return;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kColumns, Eigen::RowMajor>>(jacobian, rows_, kColumns) =
        derivative.middleRows(first_row_, rows_);
  }

  const BundleTask& task_;
  size_t observation_;
  int first_row_, rows_;
};

/// Prior: difference of a parameter block from given values, weighted by inverse variances.
class PriorCost : public ceres::CostFunction {
 public:
  PriorCost(Eigen::VectorXd mean, const Eigen::VectorXd& information)
      : mean_(std::move(mean)), root_(information.cwiseSqrt()) {
    set_num_residuals(static_cast<int>(mean_.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(mean_.size()));
  }

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    const Eigen::Index n = mean_.size();
    Eigen::Map<Eigen::VectorXd>(residuals, n) =
        root_.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(x[0], n) - mean_);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::MatrixXd>(jacobians[0], n, n) = root_.asDiagonal();
    }
    return true;
  }

 private:
  Eigen::VectorXd mean_, root_;
};

/// Huber loss without second derivative, so that Ceres reweights like the built-in solver.
class ReweightingLoss : public ceres::LossFunction {
 public:
  explicit ReweightingLoss(double width) : loss_{width} {}
  void Evaluate(double squared, double rho[3]) const override {
    rho[0] = loss_.rho(squared);
    rho[1] = loss_.weight(squared);
    rho[2] = 0;
  }

 private:
  HuberLoss loss_;
};

/// The unknowns as Ceres parameter blocks.
struct Blocks {
  std::vector<PackedPose> poses;
  std::vector<Eigen::Vector3d> points;
  SensorVector corrections;

  explicit Blocks(const BundleState& state) : points(state.p_world), corrections(state.corrections) {
    for (const SE3& T : state.T_world_camera) poses.push_back(pack(T));
  }

  [[nodiscard]] BundleState state() const {
    BundleState state{{}, points, corrections};
    for (const PackedPose& pose : poses) state.T_world_camera.push_back(unpack(pose.data()));
    return state;
  }
};

void add_parameters(const BundleTask& task, Blocks& blocks, ceres::Problem& problem) {
  for (size_t i = 0; i < blocks.poses.size(); ++i) {
    double* pose = blocks.poses[i].data();
    problem.AddParameterBlock(pose, kPoseSize);
    set_manifold(problem, pose);
    if (task.fixed[i] != 0) problem.SetParameterBlockConstant(pose);
  }
  problem.AddParameterBlock(blocks.corrections.data(), kSensorParameterCount);
  std::vector<int> held;
  for (int i = 0; i < kSensorParameterCount; ++i) {
    if (!(task.prior.sigma(i) > 0)) held.push_back(i);
  }
  if (held.size() == kSensorParameterCount) {
    problem.SetParameterBlockConstant(blocks.corrections.data());
  } else if (!held.empty()) {
#if CERES_VERSION_MAJOR > 2 || (CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR >= 1)
    problem.SetManifold(blocks.corrections.data(), new ceres::SubsetManifold(kSensorParameterCount, held));
#else
    problem.SetParameterization(blocks.corrections.data(),
                                new ceres::SubsetParameterization(kSensorParameterCount, held));
#endif
  }
}

void add_residuals(const BundleTask& task, Blocks& blocks, ceres::LossFunction* loss,
                   ceres::Problem& problem) {
  for (size_t i = 0; i < task.uses.size(); ++i) {
    if (task.uses[i] == BundleUse::kNothing) continue;
    const BundleObservation& o = task.problem.observations[i];
    const std::vector<double*> parameters = {blocks.poses[o.pose].data(), blocks.points[o.point].data(),
                                             blocks.corrections.data()};
    problem.AddResidualBlock(new ObservationCost(task, i, false), loss, parameters);
    if (task.uses[i] == BundleUse::kPixelAndDepth) {
      problem.AddResidualBlock(new ObservationCost(task, i, true), loss, parameters);
    }
  }
  SensorVector information = SensorVector::Zero();
  for (const int i : task.prior.free_parameters()) information(i) = task.prior.information(i);
  problem.AddResidualBlock(new PriorCost(task.prior.mean, information), nullptr, blocks.corrections.data());
}

ceres::Solver::Options solver_options(const BundleTask& task, const Blocks& blocks, ceres::Problem& problem) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.max_num_iterations = task.options.max_iterations;
  options.function_tolerance = task.tolerance;
  options.gradient_tolerance = 0;  // depends on units, unlike the relative decrease of the cost
  options.parameter_tolerance = 0;
  options.num_threads = 1;  // fixed summation order: identical results in every run
  options.logging_type = ceres::SILENT;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  std::vector<double*> all;
  problem.GetParameterBlocks(&all);
  for (double* block : all) ordering->AddElementToGroup(block, 1);
  for (const Eigen::Vector3d& point : blocks.points) {
    if (problem.HasParameterBlock(point.data())) {
      ordering->AddElementToGroup(const_cast<double*>(point.data()), 0);  // eliminated first
    }
  }
  options.linear_solver_ordering = ordering;
  return options;
}

}  // namespace

BundleRoundResult minimize_with_ceres(const BundleTask& task, const BundleState& state) {
  Blocks blocks(state);
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  ReweightingLoss loss(task.problem.sensor.noise.robust_width);
  add_parameters(task, blocks, problem);
  add_residuals(task, blocks, &loss, problem);
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(task, blocks, problem), &problem, &summary);
  return {blocks.state(), static_cast<int>(summary.iterations.size()) - 1,
          summary.termination_type == ceres::CONVERGENCE};
}

}  // namespace kinloop
