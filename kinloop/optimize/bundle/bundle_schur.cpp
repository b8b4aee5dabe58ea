#include "kinloop/optimize/bundle/bundle_schur.hpp"

#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "kinloop/base/parallel_for.hpp"

namespace kinloop {
namespace {

constexpr double kMinDiagonal = 1e-9;  // keeps unknowns without observations in place
// Makes a singular system solvable with negligible effect on others.
constexpr double kSmallestDamping = 1e-9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Marquardt's damping: proportional to the diagonal entry of each unknown.
template <class Diagonal>
void damp(Diagonal&& diagonal, double damping) {
  diagonal = (diagonal * (1 + damping)).cwiseMax(kMinDiagonal).eval();
}

/// Inverse, with scaling for mixed units. Unconstrained parameters get a huge variance instead of an infinite
/// one, to keep the arithmetic finite.
SensorMatrix sensor_inverse(SensorMatrix information) {
  constexpr double kMinStiffness = 1e-11;
  const SensorVector scale = information.diagonal().cwiseMax(kMinDiagonal).cwiseSqrt().cwiseInverse();
  information = (scale.asDiagonal() * information * scale.asDiagonal()).eval();
  information.diagonal().array() += kMinStiffness;
  const SensorMatrix inverse = information.llt().solve(SensorMatrix::Identity());
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

/// Replaces the equations of the unknowns with a given step (not NaN) in S x = b by that step.
void prescribe(const SensorVector& steps, SensorMatrix& S, SensorVector& b) {
  for (int k = 0; k < kSensorParameterCount; ++k) {
    if (std::isnan(steps(k))) continue;
    b -= S.col(k) * steps(k);
    S.row(k).setZero();
    S.col(k).setZero();
    S(k, k) = 1;
    b(k) = steps(k);
  }
}

}  // namespace

BundleSchur::BundleSchur(const BundleTask& task)
    : normal_(task),
      plan_(plan_elimination(normal_.pattern)),
      cholesky_(plan_),
      H_point_inverse_(normal_.points.size()),
      Y_(normal_.slots.size()) {}

void BundleSchur::invert_points(double damping) {
  parallel_for(normal_.points.size(), normal_.task.options.threads, [&](size_t begin, size_t end) {
    for (size_t index = begin; index < end; ++index) {
      const auto& point = normal_.points[index];
      Eigen::Matrix3d H = point.H;
      H.diagonal() *= 1 + damping;
      bool invertible = false;
      H.computeInverseWithCheck(H_point_inverse_[index], invertible);
      if (!invertible) H_point_inverse_[index].setZero();  // the point does not move
      for (size_t i = point.first; i < point.last; ++i) {
        Y_[i].noalias() = normal_.H_camera_point[i] * H_point_inverse_[index];
      }
    }
  });
}

/// Eliminates the points from one column of the camera system and from its right-hand sides.
void BundleSchur::reduce_column(size_t camera, Reduced& system) const {
  std::vector<Normal::Block*> block_of(system.A.diagonal.size(), nullptr);  // indexed by row
  block_of[camera] = &system.A.diagonal[camera];
  for (size_t i = normal_.column_begin[camera]; i < normal_.column_begin[camera + 1]; ++i) {
    block_of[normal_.pattern.off_diagonal[i].first] = &system.A.off_diagonal[i];
  }
  const auto row = static_cast<Eigen::Index>(kCameraDof * camera);
  auto a = system.a.segment<kCameraDof>(row);
  auto B = system.B.middleRows<kCameraDof>(row);
  for (const uint32_t i : normal_.slots_of_pose[normal_.pose_of_camera[camera]]) {
    const uint32_t index = normal_.slots[i].point;
    const auto& point = normal_.points[index];
    const Eigen::Matrix<double, 3, kCameraDof> Y = Y_[i].transpose();
    for (size_t other = point.first; other < point.last; ++other) {
      const int other_camera = normal_.slots[other].camera;
      if (other_camera < static_cast<int>(camera)) continue;
      block_of[static_cast<size_t>(other_camera)]->noalias() -= normal_.H_camera_point[other].lazyProduct(Y);
    }
    a.noalias() += Y_[i] * point.g;
    if (normal_.has_sensor) B.noalias() -= Y_[i].lazyProduct(normal_.H_sensor_point[index].transpose());
  }
}

void BundleSchur::reduce_sensor(Reduced& system) const {
  for (size_t i = 0; i < normal_.H_sensor_point.size(); ++i) {
    const auto& H = normal_.H_sensor_point[i];
    const Eigen::Matrix<double, Normal::kSensor, 3> Y = H.lazyProduct(H_point_inverse_[i]);
    system.S.noalias() -= Y.lazyProduct(H.transpose());
    system.b.noalias() += Y * normal_.points[i].g;
  }
}

BundleSchur::Reduced BundleSchur::reduce(double damping) {
  invert_points(damping);
  Reduced system{normal_.H_camera, normal_.H_camera_sensor, normal_.H_sensor, -normal_.g_camera,
                 -normal_.g_sensor};
  const size_t cameras = system.A.diagonal.size();
  for (auto& block : system.A.diagonal) damp(block.diagonal(), damping);
  damp(system.S.diagonal(), damping);
  parallel_for(cameras, normal_.task.options.threads, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) reduce_column(c, system);
  });
  reduce_sensor(system);
  return system;
}

std::optional<BundleStep> BundleSchur::solve(double damping, const SensorVector& sensor_steps) {
  const Reduced system = reduce(damping);
  if (!cholesky_.factorize(system.A)) return std::nullopt;
  BundleStep step;
  step.cameras = cholesky_.solve(system.a);
  if (normal_.has_sensor) {
    const CameraSensor A_inverse_B = cholesky_.solve<Eigen::MatrixXd>(system.B);
    SensorMatrix S = system.S - system.B.transpose() * A_inverse_B;
    SensorVector b = system.b - system.B.transpose() * step.cameras;
    prescribe(sensor_steps, S, b);
    const Eigen::LLT<SensorMatrix> llt(S);
    if (llt.info() != Eigen::Success) return std::nullopt;
    step.sensor = llt.solve(b);
    step.cameras -= A_inverse_B * step.sensor;
  }
  step.points = point_steps(step);
  const bool finite = step.cameras.allFinite() && step.sensor.allFinite();
  return finite ? std::optional(step) : std::nullopt;
}

/// Back-substitution of the points from cameras c and sensor s: H p = -g - H_camera_point' c -
/// H_sensor_point' s.
std::vector<Eigen::Vector3d> BundleSchur::point_steps(const BundleStep& step) const {
  std::vector<Eigen::Vector3d> steps(normal_.points.size());
  parallel_for(steps.size(), normal_.task.options.threads, [&](size_t begin, size_t end) {
    for (size_t index = begin; index < end; ++index) {
      const auto& point = normal_.points[index];
      Eigen::Vector3d right = -point.g;
      if (normal_.has_sensor) right -= normal_.H_sensor_point[index].transpose() * step.sensor;
      for (size_t i = point.first; i < point.last; ++i) {
        const int camera = normal_.slots[i].camera;
        if (camera < 0) continue;
        right -=
            normal_.H_camera_point[i].transpose() * step.cameras.segment<kCameraDof>(kCameraDof * camera);
      }
      steps[index] = H_point_inverse_[index] * right;
    }
  });
  return steps;
}

BundleState BundleSchur::apply(const BundleState& state, const BundleStep& step) const {
  BundleState next = state;
  for (size_t camera = 0; camera < normal_.pose_of_camera.size(); ++camera) {
    const uint32_t pose = normal_.pose_of_camera[camera];
    const auto d = step.cameras.segment<kCameraDof>(static_cast<Eigen::Index>(kCameraDof * camera));
    next.T_world_camera[pose] = state.T_world_camera[pose] * SE3::exp(d.head<6>());
  }
  next.sensor += step.sensor;
  for (size_t i = 0; i < step.points.size(); ++i) next.p_world[normal_.points[i].id] += step.points[i];
  return next;
}

BundleCovariance BundleSchur::covariance() {
  for (const double damping : {0.0, kSmallestDamping}) {
    const Reduced system = reduce(damping);
    if (cholesky_.factorize(system.A)) return covariance_of(system);
  }
  return unconstrained_covariance();
}

BundleCovariance BundleSchur::unconstrained_covariance() const {
  const BundleTask& task = normal_.task;
  BundleCovariance covariance;
  covariance.sensor.diagonal() =
      (normal_.sensor_free.array() > 0).select(SensorVector::Constant(kInfinity), 0);
  if (!task.options.pose_covariances) return covariance;
  for (const uint8_t fixed : task.fixed) {
    covariance.poses.emplace_back(Vector6d::Constant(fixed != 0 ? 0 : kInfinity).asDiagonal());
  }
  return covariance;
}

/// Block inverse of [A B; B' S] with A factorised: the sensor block is the inverse of its Schur complement;
/// the camera block is A^-1 plus the contribution of the sensor uncertainty.
BundleCovariance BundleSchur::covariance_of(const Reduced& system) const {
  BundleCovariance covariance = unconstrained_covariance();
  const CameraSensor A_inverse_B = cholesky_.solve<Eigen::MatrixXd>(system.B);
  if (normal_.has_sensor) {
    const auto& free = normal_.sensor_free;
    const SensorMatrix all = sensor_inverse(system.S - system.B.transpose() * A_inverse_B);
    covariance.sensor = free.asDiagonal() * all * free.asDiagonal();
  }
  if (!normal_.task.options.pose_covariances) return covariance;
  const auto diagonal = cholesky_.inverse_diagonal();
  for (size_t camera = 0; camera < diagonal.size(); ++camera) {
    const auto J_sensor = A_inverse_B.middleRows<6>(static_cast<Eigen::Index>(kCameraDof * camera));
    covariance.poses[normal_.pose_of_camera[camera]] =
        diagonal[camera].topLeftCorner<6, 6>() + J_sensor * covariance.sensor * J_sensor.transpose();
  }
  return covariance;
}

}  // namespace kinloop
