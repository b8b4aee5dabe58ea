#include "kinloop/optimize/bundle/bundle_model.hpp"

#include <limits>
#include <numeric>

#include <Eigen/Geometry>

#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/optimize/pose/camera_observations.hpp"

namespace kinloop {

std::vector<BundleView> views_of(const BundleTask& task, const BundleState& state) {
  std::vector<BundleView> views;
  views.reserve(state.T_world_camera.size());
  for (size_t i = 0; i < state.T_world_camera.size(); ++i) {
    views.emplace_back(state.T_world_camera[i], task.velocities[i]);
  }
  return views;
}

Sensor sensor_at(const BundleTask& task, const BundleState& state) {
  return {task.problem.sensor.camera, task.problem.sensor.noise, state.corrections};
}

ObservationBlock block_at(const BundleTask& task, const BundleBlock& block, const BundleState& state) {
  ObservationBlock placed = block.measured;
  for (size_t lane = 0; lane < block.count; ++lane) {
    const BundleUse use = task.uses[block.observations[lane]];
    const Eigen::Vector3d& p_world = state.p_world[block.points[lane]];
    placed.x[lane] = p_world.x();
    placed.y[lane] = p_world.y();
    placed.z[lane] = p_world.z();
    placed.uses_pixel[lane] = use != BundleUse::kNothing ? 1 : 0;
    placed.uses_depth[lane] = use == BundleUse::kPixelAndDepth ? 1 : 0;
  }
  return placed;
}

std::vector<uint8_t> used_points(const BundleTask& task) {
  std::vector<uint8_t> used(task.problem.p_world.size(), 0);
  for (size_t i = 0; i < task.uses.size(); ++i) {
    if (task.uses[i] != BundleUse::kNothing) used[task.problem.observations[i].point] = 1;
  }
  return used;
}

LinearizedObservation linearize_observation(const Sensor& sensor, const KeypointMeasurement& measured,
                                            BundleUse use, const BundleView& view,
                                            const Eigen::Vector3d& p_world) {
  ObservationBlock block;
  set_measurement(block, 0, measured);
  block.x[0] = p_world.x();
  block.y[0] = p_world.y();
  block.z[0] = p_world.z();
  block.uses_pixel[0] = use != BundleUse::kNothing ? 1 : 0;
  block.uses_depth[0] = use == BundleUse::kPixelAndDepth ? 1 : 0;
  if (use != BundleUse::kPixelAndDepth) block.inverse_depth_per_m[0] = 0;
  Sensor unweighted = sensor;
  unweighted.noise.robust_width = std::numeric_limits<double>::infinity();

  constexpr size_t kLanes = ObservationBlock::kSize, kWidth = LinearColumns::kMaxWidth;
  const LinearColumns layout = LinearColumns::of_all();
  std::array<double, kRowsPerObservation * kWidth * kLanes> columns{};
  linearize_block(block, view, unweighted, layout, columns.data());
  const Eigen::Map<const Eigen::Matrix<double, 3, kWidth, Eigen::RowMajor>, 0,
                   Eigen::Stride<kWidth * kLanes, kLanes>>
      row(columns.data());  // of the first lane
  const auto at = [](size_t column) { return static_cast<Eigen::Index>(column); };
  LinearizedObservation linear;
  linear.seen = block_residuals(block, view, unweighted).seen[0] > 0;
  linear.e = row.col(LinearColumns::kResidual);
  linear.J_pose = row.leftCols<6>();
  linear.J_velocity = row.middleCols<6>(at(*layout.velocity));
  linear.J_point = row.middleCols<3>(at(*layout.point));
  linear.J_sensor = row.middleCols<kSensorParameterCount>(layout.of_sensor[0]);
  return linear;
}

double bundle_cost(const BundleTask& task, const BundleState& state) {
  const auto views = views_of(task, state);
  const Sensor sensor = sensor_at(task, state);
  std::vector<double> cost_of_pose(views.size(), 0);
  parallel_for(views.size(), task.options.threads, [&](size_t begin, size_t end) {
    for (size_t pose = begin; pose < end; ++pose) {
      for (const BundleBlock& block : task.blocks_of_pose[pose]) {
        for (const double cost : block_cost(block_at(task, block, state), views[pose], sensor)) {
          cost_of_pose[pose] += cost;
        }
      }
    }
  });
  double cost = std::accumulate(cost_of_pose.begin(), cost_of_pose.end(), 0.0);
  const SensorVector moved = state.corrections - task.prior.mean;
  for (const int i : task.prior.free_parameters()) {
    cost += moved(i) * moved(i) * task.prior.information(i);
  }
  return cost;
}

}  // namespace kinloop
