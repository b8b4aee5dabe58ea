#include "kinloop/optimize/bundle/bundle_normal.hpp"

#include <algorithm>

#include "kinloop/base/parallel_for.hpp"
#include "kinloop/optimize/kernels/gram.hpp"

namespace kinloop {
namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The three rows of one observation.
template <int kColumns>
using Rows = Eigen::Map<const Eigen::Matrix<double, 3, kColumns, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;

}  // namespace

BundleNormalEquations::BundleNormalEquations(const BundleTask& bundle_task)
    : task(bundle_task),
      sensor_free((bundle_task.sensor.prior_sigma.array() > 0).cast<double>()),
      has_sensor(sensor_free.any()),
      layout(false, has_sensor) {
  number_unknowns();
  make_rows();
  make_pattern();
  H_camera = BlockMatrix<kCameraDof>(pattern);
  H_camera_point.resize(slots.size());
  const auto size = static_cast<Eigen::Index>(kCameraDof * pose_of_camera.size());
  g_camera = Eigen::VectorXd::Zero(size);
  H_camera_sensor = CameraSensor::Zero(size, kSensor);
  if (has_sensor) H_sensor_point.resize(points.size());
}

/// Sorts the observations in use by point and numbers the free unknowns.
void BundleNormalEquations::number_unknowns() {
  const BundleProblem& problem = task.problem;
  const size_t poses = problem.T_world_camera.size();
  std::vector<std::vector<uint32_t>> seen(problem.p_world.size());
  std::vector<uint8_t> touched(poses, 0);
  for (uint32_t i = 0; i < problem.observations.size(); ++i) {
    if (task.uses[i] == BundleUse::kNothing) continue;
    seen[problem.observations[i].point].push_back(i);
    touched[problem.observations[i].pose] = 1;
  }
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

/// Assigns rows to every observation, in use or not.
void BundleNormalEquations::make_rows() {
  std::vector<size_t> row_of(task.uses.size());
  size_t blocks = 0;
  for (const auto& blocks_of_pose : task.blocks_of_pose) {
    first_block.push_back(blocks);
    for (const BundleBlock& block : blocks_of_pose) {
      for (size_t lane = 0; lane < block.count; ++lane) {
        row_of[block.observations[lane]] = blocks * ObservationBlock::kSize + lane;
      }
      ++blocks;
    }
  }
  for (Slot& slot : slots) slot.place = row_of[slot.observation];
  const size_t row_count = blocks * ObservationBlock::kSize * kRowsPerObservation;
  rows.resize(row_count * layout.width);
  J_point.resize(row_count * 3);
}

/// Two cameras are coupled if they observe a common point.
void BundleNormalEquations::make_pattern() {
  const auto cameras = static_cast<uint32_t>(pose_of_camera.size());
  pattern.size = cameras;
  for (uint32_t column = 0; column < cameras; ++column) {
    std::vector<uint8_t> in_column(cameras, 0);
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

void BundleNormalEquations::linearize(const BundleState& state) {
  const auto views = views_of(task, state);
  const int threads = task.options.threads;
  H_camera.set_zero();
  std::vector<SensorPart> parts(views.size());
  parallel_for(parts.size(), threads, [&](size_t begin, size_t end) {
    for (size_t pose = begin; pose < end; ++pose) parts[pose] = linearize_pose(pose, state, views[pose]);
  });
  parallel_for(points.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) sum_point(points[i]);
  });
  H_sensor = SensorVector(SensorVector::Ones() - sensor_free).asDiagonal();  // fixed parameters do not move
  g_sensor.setZero();
  for (const SensorPart& part : parts) {
    H_sensor += part.H;
    g_sensor += part.g;
  }
  add_priors(state);
}

/// Fills in the rows of a pose, sums their contribution to the pose block and returns that to the sensor
/// block.
BundleNormalEquations::SensorPart BundleNormalEquations::linearize_pose(size_t pose, const BundleState& state,
                                                                        const BundleView& view) {
  constexpr size_t kRows = ObservationBlock::kSize * kRowsPerObservation;
  const MeasurementModel model = measurement_model(task, state.sensor);
  const auto width = static_cast<Eigen::Index>(layout.width);
  RowMajorMatrix gram = RowMajorMatrix::Zero(width, width);
  size_t row = first_block[pose] * kRows;
  for (const BundleBlock& block : task.blocks_of_pose[pose]) {
    double* const begin = &rows[row * layout.width];
    linearize_block(block_at(task, block, state), view, model, layout, begin, &J_point[row * 3]);
    add_gram(begin, kRows, layout.width, gram.data());
    row += kRows;
  }
  const auto residual = static_cast<Eigen::Index>(layout.residual);
  const int camera = camera_of_pose[pose];
  if (camera >= 0) {
    H_camera.diagonal[static_cast<size_t>(camera)] =
        gram.topLeftCorner<kCameraDof, kCameraDof>().selfadjointView<Eigen::Upper>();
    g_camera.segment<kCameraDof>(kCameraDof * camera) = gram.col(residual).head<kCameraDof>();
  }
  SensorPart part;
  if (!has_sensor) return part;
  if (camera >= 0) {
    H_camera_sensor.middleRows<kCameraDof>(kCameraDof * camera) =
        gram.block<kCameraDof, kSensor>(0, kCameraDof) * sensor_free.asDiagonal();
  }
  part.H = gram.block<kSensor, kSensor>(kCameraDof, kCameraDof).selfadjointView<Eigen::Upper>();
  part.H = (sensor_free.asDiagonal() * part.H * sensor_free.asDiagonal()).eval();
  part.g = sensor_free.cwiseProduct(gram.col(residual).segment<kSensor>(kCameraDof));
  return part;
}

/// Sums the contributions of a point's observations to its own block and to those shared with cameras and
/// sensor.
void BundleNormalEquations::sum_point(Point& point) {
  point.H.setZero();
  point.g.setZero();
  SensorPoint J_sensor = SensorPoint::Zero();
  const Eigen::OuterStride<> stride(static_cast<Eigen::Index>(layout.width));
  for (size_t i = point.first; i < point.last; ++i) {
    const size_t row = slots[i].place * kRowsPerObservation;
    const Rows<Eigen::Dynamic> all(&rows[row * layout.width], 3, stride.outer(), stride);
    const Rows<3> J(&J_point[row * 3], 3, 3, Eigen::OuterStride<>(3));
    H_camera_point[i].noalias() = all.leftCols<kCameraDof>().transpose().lazyProduct(J);
    point.H.noalias() += J.transpose().lazyProduct(J);
    point.g.noalias() += J.transpose() * all.col(static_cast<Eigen::Index>(layout.residual));
    if (has_sensor) J_sensor.noalias() += all.middleCols<kSensor>(kCameraDof).transpose().lazyProduct(J);
  }
  if (has_sensor) H_sensor_point[slots[point.first].point] = sensor_free.asDiagonal() * J_sensor;
}

void BundleNormalEquations::add_priors(const BundleState& state) {
  for (const int i : free_sensor_parameters(task.sensor)) {
    const double information = sensor_information(task.sensor, i);
    H_sensor(i, i) += information;
    g_sensor(i) += information * (state.sensor(i) - task.sensor.prior_mean(i));
  }
}

}  // namespace kinloop
