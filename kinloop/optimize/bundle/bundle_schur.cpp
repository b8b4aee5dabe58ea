#include "kinloop/optimize/bundle/bundle_schur.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/optimize/kernels/gram.hpp"

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
Eigen::MatrixXd sensor_inverse(Eigen::MatrixXd information) {
  constexpr double kMinStiffness = 1e-11;
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(kMinDiagonal).cwiseSqrt().cwiseInverse();
  information = (scale.asDiagonal() * information * scale.asDiagonal()).eval();
  information.diagonal().array() += kMinStiffness;
  const auto size = information.rows();
  const Eigen::MatrixXd inverse = information.llt().solve(Eigen::MatrixXd::Identity(size, size));
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

/// Replaces the equation of unknown k in S x = b by x(k) = step.
void prescribe(Eigen::Index k, double step, Eigen::MatrixXd& S, Eigen::VectorXd& b) {
  b -= S.col(k) * step;
  S.row(k).setZero();
  S.col(k).setZero();
  S(k, k) = 1;
  b(k) = step;
}

size_t rounded_up(size_t value, size_t step) {
  return (value + step - 1) / step * step;
}

}  // namespace

BundleSchur::BundleSchur(const BundleTask& task)
    : normal_(task),
      plan_(plan_elimination(normal_.pattern)),
      cholesky_(plan_),
      factors_(normal_.points.size()),
      border_stride_(normal_.has_sensor() ? rounded_up(normal_.products.border, kWidthStep) : 1),
      border_(3 * border_stride_ * normal_.points.size()) {
  auto& memory = task.buffers.eliminated;
  const size_t needed = kEliminatedSize * normal_.camera_of_slot.size();
  if (memory.size() < needed) memory = std::vector<double>(needed);
}

void BundleSchur::eliminate_points(double damping) {
  const size_t border = normal_.products.border;
  std::vector<double>& U = normal_.task.buffers.eliminated;
  parallel_for(normal_.points.size(), normal_.task.options.threads, [&](size_t begin, size_t end) {
    for (size_t index = begin; index < end; ++index) {
      const double* sums = normal_.sums_of(index);
      std::array<double, 6> H;
      std::copy_n(sums + 3 * border, 6, H.begin());
      for (const size_t diagonal : {0U, 3U, 5U}) H[diagonal] *= 1 + damping;
      const PointFactor f(H);
      factors_[index] = f;
      double* const to = &border_[3 * border_stride_ * index];
      for (size_t c = 0; c < border; ++c) {
        const double u0 = sums[c] * f.i00, u1 = (sums[border + c] - f.l10 * u0) * f.i11;
        to[c] = u0;
        to[border_stride_ + c] = u1;
        to[2 * border_stride_ + c] = (sums[2 * border + c] - f.l20 * u0 - f.l21 * u1) * f.i22;
      }
      const auto& point = normal_.points[index];
      eliminate_point(f, normal_.products_of(point.first), normal_.products.size(), point.last - point.first,
                      &U[point.first * kEliminatedSize]);
    }
  });
}

/// Eliminates the points from one column of the camera system and from its right-hand sides.
void BundleSchur::reduce_column(size_t camera, Reduced& system) const {
  const size_t first = normal_.column_begin[camera], last = normal_.column_begin[camera + 1];
  std::vector<uint32_t> block_of(system.A.diagonal.size(), 0);  // 0: the diagonal
  for (size_t i = first; i < last; ++i) {
    block_of[normal_.pattern.off_diagonal[i].first] = static_cast<uint32_t>(1 + i - first);
  }
  const size_t border = normal_.products.border;
  std::vector<double> blocks((1 + last - first) * kSchurBlockSize, 0), right(border * kEliminatedWidth, 0);
  const SchurColumn column{normal_.slots_of_camera[camera],
                           block_of,
                           normal_.camera_of_slot.data(),
                           normal_.task.buffers.eliminated.data(),
                           border_.data(),
                           border,
                           border_stride_};
  add_schur_column(column, blocks.data(), right.data());
  const auto block = [&](size_t i) {
    return Eigen::Map<const Normal::Block, 0, Eigen::OuterStride<>>(&blocks[i * kSchurBlockSize],
                                                                    Eigen::OuterStride<>(kEliminatedWidth));
  };
  system.A.diagonal[camera] -= block(0);
  for (size_t i = first; i < last; ++i) system.A.off_diagonal[i] = -block(1 + i - first);
  for (size_t c = 0; c < border; ++c) {
    system.a_B.col(static_cast<Eigen::Index>(c))
        .segment<kCameraDof>(static_cast<Eigen::Index>(kCameraDof * camera)) -=
        Eigen::Map<const Vector6d>(&right[c * kEliminatedWidth]);
  }
}

void BundleSchur::reduce_sensor(Reduced& system) const {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto stride = static_cast<Eigen::Index>(border_stride_);
  RowMajor gram = RowMajor::Zero(stride, stride);
  add_gram(border_.data(), 3 * normal_.points.size(), border_stride_, gram.data());
  const auto size = system.S.rows();
  system.S -= Eigen::MatrixXd(gram.topLeftCorner(size, size).selfadjointView<Eigen::Upper>());
}

BundleSchur::Reduced BundleSchur::reduce(double damping) {
  eliminate_points(damping);
  Reduced system{BlockMatrix<kCameraDof>(normal_.pattern), normal_.H_camera_border, normal_.H_border};
  const size_t cameras = system.A.diagonal.size();
  for (size_t c = 0; c < cameras; ++c) {
    system.A.diagonal[c] = normal_.H_camera[c];
    damp(system.A.diagonal[c].diagonal(), damping);
  }
  damp(system.S.diagonal().tail(system.S.rows() - 1), damping);
  parallel_for(cameras, normal_.task.options.threads, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) reduce_column(c, system);
  });
  if (normal_.has_sensor()) reduce_sensor(system);
  return system;
}

std::optional<BundleStep> BundleSchur::solve(double damping, const SensorVector& sensor_steps) {
  const Reduced system = reduce(damping);
  if (!cholesky_.factorize(system.A)) return std::nullopt;
  const Eigen::MatrixXd A_inverse_a_B = cholesky_.solve<Eigen::MatrixXd>(system.a_B);
  const auto sensor = sensor_step(system, A_inverse_a_B, sensor_steps);
  if (!sensor) return std::nullopt;
  BundleStep step;
  step.cameras = -A_inverse_a_B.col(0) - A_inverse_a_B.rightCols(sensor->size()) * *sensor;
  for (size_t i = 0; i < normal_.columns.sensor_count; ++i) {
    step.sensor(normal_.columns.sensor_parameters[i]) = (*sensor)(static_cast<Eigen::Index>(i));
  }
  step.points = point_steps(step.cameras, *sensor);
  const bool finite = step.cameras.allFinite() && step.sensor.allFinite();
  return finite ? std::optional(step) : std::nullopt;
}

/// Step of the free sensor parameters, or nullopt if their system is singular.
std::optional<Eigen::VectorXd> BundleSchur::sensor_step(const Reduced& system,
                                                        const Eigen::MatrixXd& A_inverse_a_B,
                                                        const SensorVector& sensor_steps) const {
  if (!normal_.has_sensor()) return Eigen::VectorXd();
  const auto size = static_cast<Eigen::Index>(normal_.columns.sensor_count);
  Eigen::MatrixXd S = system.sensor() - system.B().transpose() * A_inverse_a_B.rightCols(size);
  Eigen::VectorXd b = system.B().transpose() * A_inverse_a_B.col(0) - system.b();
  for (Eigen::Index i = 0; i < size; ++i) {
    const double prescribed = sensor_steps(normal_.columns.sensor_parameters[static_cast<size_t>(i)]);
    if (!std::isnan(prescribed)) prescribe(i, prescribed, S, b);
  }
  const Eigen::LLT<Eigen::MatrixXd> llt(S);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return llt.solve(b);
}

/// Back-substitution of the points from cameras c and sensor s: L' p = -(L^-1 g + U c + L^-1 H_point_sensor
/// s).
std::vector<Eigen::Vector3d> BundleSchur::point_steps(const Eigen::VectorXd& cameras,
                                                      const Eigen::VectorXd& sensor) const {
  std::vector<Eigen::Vector3d> steps(normal_.points.size());
  parallel_for(steps.size(), normal_.task.options.threads, [&](size_t begin, size_t end) {
    for (size_t index = begin; index < end; ++index) {
      const auto& point = normal_.points[index];
      Eigen::Vector3d sum;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double* border = &border_[(3 * index + static_cast<size_t>(axis)) * border_stride_];
        sum(axis) = border[0] + Eigen::Map<const Eigen::VectorXd>(border + 1, sensor.size()).dot(sensor);
      }
      using Eliminated = Eigen::Map<const Eigen::Matrix<double, kCameraDof, 3>, 0, Eigen::OuterStride<>>;
      for (size_t slot = point.first; slot < point.last; ++slot) {
        const int camera = normal_.camera_of_slot[slot];
        if (camera < 0) continue;
        const Eliminated U(&normal_.task.buffers.eliminated[slot * kEliminatedSize],
                           Eigen::OuterStride<>(kEliminatedWidth));
        sum.noalias() += U.transpose() * cameras.segment<kCameraDof>(kCameraDof * camera);
      }
      const PointFactor& f = factors_[index];
      Eigen::Vector3d& p = steps[index];
      p.z() = -sum.z() * f.i22;
      p.y() = (-sum.y() - f.l21 * p.z()) * f.i11;
      p.x() = (-sum.x() - f.l10 * p.y() - f.l20 * p.z()) * f.i00;
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
  next.corrections += step.sensor;
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
  for (const int k : task.prior.free_parameters()) covariance.sensor(k, k) = kInfinity;
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
  const Eigen::MatrixXd B = system.B();
  const Eigen::MatrixXd A_inverse_B = cholesky_.solve<Eigen::MatrixXd>(B);
  const Eigen::MatrixXd sensor = sensor_inverse(system.sensor() - B.transpose() * A_inverse_B);
  for (size_t i = 0; i < normal_.columns.sensor_count; ++i) {
    for (size_t j = 0; j < normal_.columns.sensor_count; ++j) {
      covariance.sensor(normal_.columns.sensor_parameters[i], normal_.columns.sensor_parameters[j]) =
          sensor(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  if (!normal_.task.options.pose_covariances) return covariance;
  const auto diagonal = cholesky_.inverse_diagonal();
  for (size_t camera = 0; camera < diagonal.size(); ++camera) {
    auto& pose = covariance.poses[normal_.pose_of_camera[camera]];
    pose = diagonal[camera];
    if (B.cols() == 0) continue;  // no sensor parameter is estimated
    const auto J_sensor = A_inverse_B.middleRows<kCameraDof>(static_cast<Eigen::Index>(kCameraDof * camera));
    pose += J_sensor * sensor * J_sensor.transpose();
  }
  return covariance;
}

}  // namespace kinloop
