#pragma once
// The normal equations of bundle adjustment in block form. Unknowns: free keyframes (blocks of 6), the
// free sensor parameters, points. The residual is handled like one more sensor parameter; both are called
// border columns (H is bordered).
//
// Every sum is computed by one thread in a fixed order (points over their observations, keyframes over
// theirs), so the result does not depend on the number of threads.

#include <array>
#include <vector>

#include "kinloop/optimize/bundle/bundle_model.hpp"
#include "kinloop/optimize/kernels/bundle_products.hpp"
#include "kinloop/optimize/linear/sparse_cholesky.hpp"

namespace kinloop {

/// H x = -g for all unknowns x; H = J' J, g = J' e, with robust weights on the observations.
struct BundleNormalEquations {
  static constexpr int kCameraDof = 6;  ///< of a camera pose
  using Block = Eigen::Matrix<double, kCameraDof, kCameraDof>;

  struct Point {
    uint32_t id = 0;               ///< index in the problem
    uint32_t first = 0, last = 0;  ///< range of its slots
  };

  /// Numbers the unknowns and determines their coupling.
  explicit BundleNormalEquations(const BundleTask& task);

  /// Computes the values at `state`.
  void linearize(const BundleState& state);

  [[nodiscard]] const double* products_of(size_t slot) const {
    return &task.buffers.products[slot * products.size()];
  }
  [[nodiscard]] const double* sums_of(size_t point) const { return &point_sums[point * products.sums()]; }
  [[nodiscard]] bool has_sensor() const { return columns.sensor_count > 0; }

  const BundleTask& task;
  LinearColumns columns;
  PointProducts products;

  std::vector<int> camera_of_pose;  ///< -1 = fixed
  std::vector<uint32_t> pose_of_camera;
  std::vector<Point> points;
  /// Slots are the observations in use, sorted by point, then camera.
  std::vector<int> camera_of_slot;
  std::vector<std::vector<SchurColumn::Slot>> slots_of_camera;
  BlockPattern pattern;  ///< of the cameras, including the fill-in from eliminating the points
  /// First entry of each camera in pattern.off_diagonal, which is sorted by column.
  std::vector<size_t> column_begin;

  std::vector<double> point_sums;   ///< per point, the sum of the PointProducts of its slots
  std::vector<Block> H_camera;      ///< diagonal; there is nothing else before points are eliminated
  Eigen::MatrixXd H_camera_border;  ///< cameras x border: gradient, then sensor
  Eigen::MatrixXd H_border;         ///< border x border

 private:
  void number_unknowns();
  void number_slots(std::vector<uint32_t> observations, const std::vector<uint32_t>& first_of_point);
  void list_slots_of_cameras();
  void make_pattern();
  Eigen::MatrixXd linearize_pose(size_t pose, const BundleState& state, const BundleView& view);
  void sum_point(size_t point);
  void add_priors(const BundleState& state);

  std::vector<std::array<uint32_t, ObservationBlock::kSize>> slots_of_block_;  // of all poses
  std::vector<size_t> first_block_;                                            // per pose
};

}  // namespace kinloop
