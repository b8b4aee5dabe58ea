#include "kinloop/optimize/bundle_normal.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/base/parallel_for.hpp"
#include "kinloop/geometry/robust_loss.hpp"

namespace kinloop {

template <int C>
BundleNormal<C>::BundleNormal(const BundleTask& bundle_task)
    : task(bundle_task),
      sensor_free((bundle_task.problem.sensor.prior_sigma.array() > 0).template cast<double>()),
      has_sensor(sensor_free.any()) {
  number_unknowns();
  make_pattern();
  H_camera = BlockMatrix<C>(pattern);
  e.resize(slots.size());
  J_camera.resize(slots.size());
  H_camera_point.resize(slots.size());
  const auto rows = static_cast<Eigen::Index>(C * pose_of_camera.size());
  g_camera = Eigen::VectorXd::Zero(rows);
  H_camera_sensor = CameraSensor::Zero(rows, kSensor);
  if (!has_sensor) return;
  J_sensor.resize(slots.size());
  H_sensor_point.resize(points.size());
}

/// Sorts the observations in use by point and counts what they and the edges leave free.
template <int C>
void BundleNormal<C>::number_unknowns() {
  const BundleProblem& problem = task.problem;
  const size_t poses = problem.T_world_camera.size();
  std::vector<std::vector<uint32_t>> seen(problem.p_world.size());
  std::vector<uint8_t> touched(poses, 0);
  for (uint32_t i = 0; i < problem.observations.size(); ++i) {
    if (task.uses[i] == BundleUse::kNothing) continue;
    seen[problem.observations[i].point].push_back(i);
    touched[problem.observations[i].pose] = 1;
  }
  for (const BundleEdge& edge : problem.edges) touched[edge.a] = touched[edge.b] = 1;
  camera_of_pose.assign(poses, -1);
  for (uint32_t pose = 0; pose < poses; ++pose) {
    if (task.fixed[pose] != 0 || touched[pose] == 0) continue;
    camera_of_pose[pose] = static_cast<int>(pose_of_camera.size());
    pose_of_camera.push_back(pose);
  }
  slots_of_pose.resize(poses);
  for (uint32_t id = 0; id < seen.size(); ++id) {
    if (seen[id].empty()) continue;
    Point point;
    point.id = id;
    point.first = slots.size();
    for (const uint32_t i : seen[id]) {
      const uint32_t pose = problem.observations[i].pose;
      slots_of_pose[pose].push_back(static_cast<uint32_t>(slots.size()));
      slots.push_back({i, camera_of_pose[pose], static_cast<uint32_t>(points.size())});
    }
    point.last = slots.size();
    points.push_back(point);
  }
}

/// Two cameras are coupled where they share a point or an edge.
template <int C>
void BundleNormal<C>::make_pattern() {
  const auto cameras = static_cast<uint32_t>(pose_of_camera.size());
  pattern.size = cameras;
  std::vector<std::vector<uint32_t>> coupled(cameras);
  for (const BundleEdge& edge : task.problem.edges) {
    const int a = camera_of_pose[edge.a], b = camera_of_pose[edge.b];
    if (a < 0 || b < 0 || a == b) continue;
    coupled[static_cast<size_t>(std::min(a, b))].push_back(static_cast<uint32_t>(std::max(a, b)));
  }
  for (uint32_t column = 0; column < cameras; ++column) {
    std::vector<uint8_t> in_column(cameras, 0);
    for (const uint32_t row : coupled[column]) in_column[row] = 1;
    for (const uint32_t slot : slots_of_pose[pose_of_camera[column]]) {
      const Point& point = points[slots[slot].point];
      for (size_t other = point.first; other < point.last; ++other) {
        if (slots[other].camera >= 0) in_column[static_cast<size_t>(slots[other].camera)] = 1;
      }
    }
    column_begin.push_back(pattern.off_diagonal.size());
    for (uint32_t row = column + 1; row < cameras; ++row) {
      if (in_column[row] != 0) pattern.off_diagonal.emplace_back(row, column);
    }
  }
  column_begin.push_back(pattern.off_diagonal.size());
}

/// The block of two coupled cameras, row >= column.
template <int C>
typename BundleNormal<C>::Block& BundleNormal<C>::H_between(uint32_t row, uint32_t column) {
  if (row == column) return H_camera.diagonal[row];
  const auto column_of = pattern.off_diagonal.begin() + static_cast<std::ptrdiff_t>(column_begin[column]);
  const auto found = std::lower_bound(column_of, pattern.off_diagonal.end(), std::pair(row, column),
                                      [](const auto& a, const auto& b) {
                                        return std::pair(a.second, a.first) < std::pair(b.second, b.first);
                                      });
  return H_camera.off_diagonal[static_cast<size_t>(found - pattern.off_diagonal.begin())];
}

template <int C>
void BundleNormal<C>::linearize(const BundleState& state) {
  const auto views = views_of(state);
  const int threads = task.options.threads;
  parallel_for(points.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) linearize_point(state, views, points[i]);
  });
  H_camera.set_zero();
  std::vector<SensorPart> parts(slots_of_pose.size());
  parallel_for(parts.size(), threads, [&](size_t begin, size_t end) {
    for (size_t pose = begin; pose < end; ++pose) parts[pose] = sum_pose(pose);
  });
  H_sensor = SensorVector(SensorVector::Ones() - sensor_free).asDiagonal();  // the held do not move
  g_sensor.setZero();
  for (const SensorPart& part : parts) {
    H_sensor += part.H;
    g_sensor += part.g;
  }
  add_edges(state);
  add_priors(state);
}

template <int C>
void BundleNormal<C>::linearize_point(const BundleState& state, const std::vector<BundleView>& views,
                                      Point& point) {
  point.H.setZero();
  point.g.setZero();
  if (has_sensor) H_sensor_point[slots[point.first].point].setZero();
  for (size_t i = point.first; i < point.last; ++i) {
    const uint32_t index = slots[i].observation;
    const BundleObservation& o = task.problem.observations[index];
    const auto linear = linearize_observation(task, o, task.uses[index], views[o.pose],
                                              state.p_world[point.id], state.sensor, {C > 6, has_sensor});
    linearize_slot(i, linear, point);
  }
}

template <int C>
void BundleNormal<C>::linearize_slot(size_t i, const LinearizedObservation& linear, Point& point) {
  const BundleResidual& r = linear.residual;
  if (!r.seen) {
    e[i].setZero();
    J_camera[i].setZero();
    H_camera_point[i].setZero();
    if (has_sensor) J_sensor[i].setZero();
    return;
  }
  const HuberLoss loss{task.options.robust_width};
  const double pixel = std::sqrt(loss.weight(r.pixel_squared()));
  const Eigen::Vector3d root(pixel, pixel, std::sqrt(loss.weight(r.depth_squared())));
  const Eigen::Matrix3d J_point = root.asDiagonal() * linear.jacobian.point;
  e[i] = root.cwiseProduct(r.e);
  J_camera[i].template leftCols<6>() = root.asDiagonal() * linear.jacobian.pose;
  if constexpr (C > 6) J_camera[i].template rightCols<6>() = root.asDiagonal() * linear.jacobian.velocity;
  H_camera_point[i].noalias() = J_camera[i].transpose() * J_point;
  point.H.noalias() += J_point.transpose() * J_point;
  point.g.noalias() += J_point.transpose() * e[i];
  if (!has_sensor) return;
  J_sensor[i] = root.asDiagonal() * linear.jacobian.sensor * sensor_free.asDiagonal();
  H_sensor_point[slots[i].point].noalias() += J_sensor[i].transpose().lazyProduct(J_point);
}

/// Sums what the observations of one pose say of the pose, and returns what they say of the sensor.
template <int C>
typename BundleNormal<C>::SensorPart BundleNormal<C>::sum_pose(size_t pose) {
  Block H = Block::Zero();
  CameraVector g = CameraVector::Zero();
  Eigen::Matrix<double, C, kSensor> by_sensor = Eigen::Matrix<double, C, kSensor>::Zero();
  SensorPart part;
  for (const uint32_t i : slots_of_pose[pose]) {
    H.noalias() += J_camera[i].transpose().lazyProduct(J_camera[i]);
    g.noalias() += J_camera[i].transpose() * e[i];
    if (!has_sensor) continue;
    by_sensor.noalias() += J_camera[i].transpose().lazyProduct(J_sensor[i]);
    part.H.noalias() += J_sensor[i].transpose().lazyProduct(J_sensor[i]);
    part.g.noalias() += J_sensor[i].transpose() * e[i];
  }
  const int camera = camera_of_pose[pose];
  if (camera < 0) return part;
  H_camera.diagonal[static_cast<size_t>(camera)] = H;
  g_camera.template segment<C>(C * camera) = g;
  H_camera_sensor.template middleRows<C>(C * camera) = by_sensor;
  return part;
}

template <int C>
void BundleNormal<C>::add_edges(const BundleState& state) {
  const auto add = [&](int row, int column, const Matrix6d& product) {
    if (row < column || column < 0) return;  // the upper triangle, or held
    Block& block = H_between(static_cast<uint32_t>(row), static_cast<uint32_t>(column));
    block.template topLeftCorner<6, 6>() += product;
  };
  for (const BundleEdge& edge : task.problem.edges) {
    const auto linear =
        linearize_bundle_edge(edge, state.T_world_camera[edge.a], state.T_world_camera[edge.b]);
    const int a = camera_of_pose[edge.a], b = camera_of_pose[edge.b];
    const Matrix6d a_weighted = linear.by_a.transpose() * edge.information;
    const Matrix6d b_weighted = linear.by_b.transpose() * edge.information;
    add(a, a, a_weighted * linear.by_a);
    add(b, b, b_weighted * linear.by_b);
    if (a != b) add(a, b, a_weighted * linear.by_b);
    if (a != b) add(b, a, b_weighted * linear.by_a);
    if (a >= 0) g_camera.template segment<6>(C * a) += a_weighted * linear.e;
    if (b >= 0) g_camera.template segment<6>(C * b) += b_weighted * linear.e;
  }
}

template <int C>
void BundleNormal<C>::add_priors(const BundleState& state) {
  if constexpr (C > 6) {
    const Vector6d information = velocity_information(task.options);
    for (size_t camera = 0; camera < pose_of_camera.size(); ++camera) {
      const uint32_t pose = pose_of_camera[camera];
      H_camera.diagonal[camera].template bottomRightCorner<6, 6>().diagonal() += information;
      g_camera.template segment<6>(static_cast<Eigen::Index>(C * camera + 6)) +=
          information.cwiseProduct(state.velocities[pose] - task.velocities[pose]);
    }
  }
  for (const int i : free_sensor_parameters(task.problem.sensor)) {
    const double information = sensor_information(task.problem.sensor, i);
    H_sensor(i, i) += information;
    g_sensor(i) += information * (state.sensor(i) - task.problem.sensor.prior_mean(i));
  }
}

template struct BundleNormal<6>;
template struct BundleNormal<12>;

}  // namespace kinloop
