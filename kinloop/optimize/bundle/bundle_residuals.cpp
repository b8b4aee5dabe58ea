#include "kinloop/optimize/bundle/bundle_residuals.hpp"

#include <algorithm>

#include "kinloop/optimize/pose/camera_observations.hpp"

namespace kinloop {
namespace {

/// Sums of the residuals (u, v, depth) of one keyframe in each part of its image.
class ClusterSums {
 public:
  explicit ClusterSums(const PinholeCamera& camera)
      : cell_px_(std::max(1.0, static_cast<double>(std::max(camera.width, camera.height)) / kCells)) {}

  void add(const ObservationBlock& block, const BlockResiduals& residuals) {
    for (size_t lane = 0; lane < ObservationBlock::kSize; ++lane) {
      if (!(block.uses_pixel[lane] > 0) || !(residuals.seen[lane] > 0)) continue;
      const double depth = block.uses_depth[lane] > 0 ? residuals.depth[lane] : 0;
      sums_.col(cell(block.pixel_y[lane]) * kCells + cell(block.pixel_x[lane])) +=
          Eigen::Vector3d(residuals.u[lane], residuals.v[lane], depth);
    }
  }

  [[nodiscard]] double squared() const {
    double sum = 0;
    for (const auto& of_cell : sums_.colwise()) sum += of_cell.squaredNorm();
    return sum;
  }

 private:
  static constexpr int kCells = 4;  // in a row: far apart, errors of lens and depth are unlike

  [[nodiscard]] int cell(double px) const {
    return static_cast<int>(std::clamp(px / cell_px_, 0.0, static_cast<double>(kCells - 1)));
  }

  double cell_px_;
  Eigen::Matrix<double, 3, kCells* kCells> sums_ = Eigen::Matrix<double, 3, kCells * kCells>::Zero();
};

/// Number of unknowns of the poses and points.
double unknowns(const BundleTask& task) {
  constexpr double kPoseDof = 6, kPointDof = 3;
  const auto points = used_points(task);
  return kPoseDof * static_cast<double>(std::count(task.fixed.begin(), task.fixed.end(), 0)) +
         kPointDof * static_cast<double>(std::count(points.begin(), points.end(), 1));
}

}  // namespace

ResidualStatistics residual_statistics(const BundleTask& task, const BundleState& state) {
  const auto views = views_of(task, state);
  const Sensor sensor = sensor_at(task, state);
  ResidualSquares squares;
  double clustered = 0;
  for (size_t pose = 0; pose < views.size(); ++pose) {
    ClusterSums clusters(sensor.camera);
    for (const BundleBlock& block : task.blocks_of_pose[pose]) {
      const ObservationBlock measured = block_at(task, block, state);
      const BlockResiduals residuals = block_residuals(measured, views[pose], sensor);
      squares.add(measured, residuals);
      clusters.add(measured, residuals);
    }
    clustered += clusters.squared();
  }
  return {squares.variance(unknowns(task)), squares.sum > 0 ? std::max(1.0, clustered / squares.sum) : 1.0};
}

}  // namespace kinloop
