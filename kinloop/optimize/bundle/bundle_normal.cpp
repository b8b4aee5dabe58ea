#include "kinloop/optimize/bundle/bundle_normal.hpp"

#include <algorithm>

#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

constexpr size_t kLanes = ObservationBlock::kSize;

}  // namespace

BundleNormalEquations::BundleNormalEquations(const BundleTask& bundle_task)
    : task(bundle_task), columns(LinearColumns::of_bundle(bundle_task.prior.sigma)), products(columns) {
  number_unknowns();
  list_slots_of_cameras();
  make_pattern();
  const size_t cameras = pose_of_camera.size();
  H_camera.resize(cameras);
  H_camera_border.setZero(static_cast<Eigen::Index>(kCameraDof * cameras),
                          static_cast<Eigen::Index>(products.border));
  point_sums.resize(points.size() * products.sums());
  // One more than needed: where observations write that are not in use.
  auto& memory = task.buffers.products;
  const size_t needed = (camera_of_slot.size() + 1) * products.size();
  if (memory.size() < needed) memory = std::vector<double>(needed);
}

/// Numbers the free unknowns and sorts the observations in use by point.
void BundleNormalEquations::number_unknowns() {
  const BundleProblem& problem = task.problem;
  const size_t poses = problem.T_world_camera.size();
  std::vector<uint32_t> end_of_point(problem.p_world.size() + 1, 0);
  std::vector<uint8_t> touched(poses, 0);
  for (size_t i = 0; i < task.uses.size(); ++i) {
    if (task.uses[i] == BundleUse::kNothing) continue;
    ++end_of_point[problem.observations[i].point + 1];
    touched[problem.observations[i].pose] = 1;
  }
  camera_of_pose.assign(poses, -1);
  for (uint32_t pose = 0; pose < poses; ++pose) {
    if (task.fixed[pose] != 0 || touched[pose] == 0) continue;
    camera_of_pose[pose] = static_cast<int>(pose_of_camera.size());
    pose_of_camera.push_back(pose);
  }
  for (size_t i = 1; i < end_of_point.size(); ++i) end_of_point[i] += end_of_point[i - 1];
  const std::vector<uint32_t> first_of_point = end_of_point;
  std::vector<uint32_t> observations(first_of_point.back());
  for (uint32_t i = 0; i < task.uses.size(); ++i) {
    if (task.uses[i] == BundleUse::kNothing) continue;
    observations[end_of_point[problem.observations[i].point]++] = i;
  }
  number_slots(std::move(observations), first_of_point);
}

/// Sorts the observations of each point by camera and assigns their slots to the blocks.
void BundleNormalEquations::number_slots(std::vector<uint32_t> observations,
                                         const std::vector<uint32_t>& first_of_point) {
  const auto camera_of = [&](uint32_t i) { return camera_of_pose[task.problem.observations[i].pose]; };
  std::vector<uint32_t> slot_of(task.uses.size(), static_cast<uint32_t>(observations.size()));
  camera_of_slot.reserve(observations.size());
  for (uint32_t id = 0; id + 1 < first_of_point.size(); ++id) {
    const uint32_t first = first_of_point[id], last = first_of_point[id + 1];
    if (first == last) continue;
    points.push_back({id, first, last});
    std::sort(observations.begin() + first, observations.begin() + last, [&](uint32_t a, uint32_t b) {
      return std::pair(camera_of(a), a) < std::pair(camera_of(b), b);
    });
    for (uint32_t slot = first; slot < last; ++slot) {
      slot_of[observations[slot]] = slot;
      camera_of_slot.push_back(camera_of(observations[slot]));
    }
  }
  for (const auto& blocks_of_pose : task.blocks_of_pose) {
    first_block_.push_back(slots_of_block_.size());
    for (const BundleBlock& block : blocks_of_pose) {
      auto& slots = slots_of_block_.emplace_back();
      slots.fill(static_cast<uint32_t>(observations.size()));
      for (size_t lane = 0; lane < block.count; ++lane) slots[lane] = slot_of[block.observations[lane]];
    }
  }
}

void BundleNormalEquations::list_slots_of_cameras() {
  slots_of_camera.resize(pose_of_camera.size());
  for (uint32_t index = 0; index < points.size(); ++index) {
    const Point& point = points[index];
    uint32_t first_of_camera = point.first;
    for (uint32_t slot = point.first; slot < point.last; ++slot) {
      const int camera = camera_of_slot[slot];
      if (camera != camera_of_slot[first_of_camera]) first_of_camera = slot;
      if (camera < 0) continue;
      slots_of_camera[static_cast<size_t>(camera)].push_back({slot, first_of_camera, point.last, index});
    }
  }
}

/// Two cameras are coupled if they share a point.
void BundleNormalEquations::make_pattern() {
  const auto cameras = static_cast<uint32_t>(pose_of_camera.size());
  pattern.size = cameras;
  for (uint32_t column = 0; column < cameras; ++column) {
    std::vector<uint8_t> in_column(cameras, 0);
    for (const SchurColumn::Slot& slot : slots_of_camera[column]) {
      for (size_t other = slot.first; other < slot.last; ++other) {
        in_column[static_cast<size_t>(camera_of_slot[other])] = 1;
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
  std::vector<Eigen::MatrixXd> parts(views.size());
  parallel_for(parts.size(), threads, [&](size_t begin, size_t end) {
    for (size_t pose = begin; pose < end; ++pose) parts[pose] = linearize_pose(pose, state, views[pose]);
  });
  parallel_for(points.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) sum_point(i);
  });
  const auto border = static_cast<Eigen::Index>(products.border);
  H_border.setZero(border, border);
  for (const Eigen::MatrixXd& part : parts) {
    if (part.size() > 0) H_border += part;
  }
  add_priors(state);
}

/// Writes the point products of a pose's observations, sums their contribution to the pose block and returns
/// that to the border block (empty if nothing needs it).
Eigen::MatrixXd BundleNormalEquations::linearize_pose(size_t pose, const BundleState& state,
                                                      const BundleView& view) {
  const Sensor sensor = sensor_at(task, state);
  const int camera = camera_of_pose[pose];
  const bool sums_gram = camera >= 0 || has_sensor();
  alignas(64) std::array<double, kRowsPerObservation * LinearColumns::kMaxWidth * kLanes> values{};
  const GramColumns summed(columns);
  std::vector<double> sums(sums_gram ? summed.sums() : 0, 0);
  const auto& blocks = task.blocks_of_pose[pose];
  for (size_t i = 0; i < blocks.size(); ++i) {
    const auto& slots = slots_of_block_[first_block_[pose] + i];
    linearize_block(block_at(task, blocks[i], state), view, sensor, columns, values.data());
    if (sums_gram) add_block_gram(summed, values.data(), sums.data());
    std::array<double*, kLanes> records;
    for (size_t lane = 0; lane < kLanes; ++lane) {
      records[lane] = &task.buffers.products[slots[lane] * products.size()];
    }
    write_point_products(columns, values.data(), records);
  }
  if (!sums_gram) return {};
  const Eigen::MatrixXd gram = gram_of_sums(summed, sums);
  if (camera >= 0) {
    H_camera[static_cast<size_t>(camera)] =
        gram.topLeftCorner<kCameraDof, kCameraDof>().selfadjointView<Eigen::Upper>();
    H_camera_border.middleRows<kCameraDof>(kCameraDof * camera) =
        gram.topRightCorner(kCameraDof, H_camera_border.cols());
  }
  if (!has_sensor()) return {};
  return gram.bottomRightCorner(H_camera_border.cols(), H_camera_border.cols())
      .selfadjointView<Eigen::Upper>();
}

void BundleNormalEquations::sum_point(size_t index) {
  const auto size = static_cast<Eigen::Index>(products.sums());
  Eigen::Map<Eigen::VectorXd> sums(&point_sums[index * products.sums()], size);
  sums.setZero();
  for (size_t slot = points[index].first; slot < points[index].last; ++slot) {
    sums += Eigen::Map<const Eigen::VectorXd>(products_of(slot) + PointProducts::kPose, size);
  }
}

void BundleNormalEquations::add_priors(const BundleState& state) {
  for (size_t i = 0; i < columns.sensor_count; ++i) {
    const int k = columns.sensor_parameters[i];
    const auto column = static_cast<Eigen::Index>(i) + 1;
    const double information = task.prior.information(k);
    H_border(column, column) += information;
    const double gradient = information * (state.corrections(k) - task.prior.mean(k));
    H_border(0, column) += gradient;
    H_border(column, 0) += gradient;
  }
}

}  // namespace kinloop
