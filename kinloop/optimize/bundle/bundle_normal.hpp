#pragma once
// The normal equations of bundle adjustment in block form. Unknowns: free keyframes (blocks of 6), the
// sensor, points.
//
// Every sum is computed by one thread in a fixed order (points over their observations, keyframes over
// theirs), so the result does not depend on the number of threads.

#include <vector>

#include "kinloop/optimize/bundle/bundle_model.hpp"
#include "kinloop/optimize/pose_graph/sparse_cholesky.hpp"

namespace kinloop {

/// H x = -g for all unknowns x; H = J' J, g = J' e, with robust weights on the observations.
struct BundleNormalEquations {
  static constexpr int kCameraDof = 6;  ///< of a camera pose
  static constexpr int kSensor = kSensorParameterCount;
  using Block = Eigen::Matrix<double, kCameraDof, kCameraDof>;
  using CameraVector = Eigen::Matrix<double, kCameraDof, 1>;
  using SensorPoint = Eigen::Matrix<double, kSensor, 3>;
  using CameraSensor = Eigen::Matrix<double, Eigen::Dynamic, kSensor>;

  /// One observation in use.
  struct Slot {
    uint32_t observation = 0;  ///< index in the problem
    int camera = -1;           ///< index of the unknown, -1 = fixed
    uint32_t point = 0;        ///< index of the unknown
    size_t place = 0;          ///< position of its rows
  };
  struct Point {
    uint32_t id = 0;             ///< index in the problem
    size_t first = 0, last = 0;  ///< range of its slots
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
  };

  /// Numbers the unknowns and determines their coupling.
  explicit BundleNormalEquations(const BundleTask& task);

  /// Computes the values at `state`.
  void linearize(const BundleState& state);

  const BundleTask& task;
  SensorVector sensor_free;  ///< 1 = free, 0 = fixed (zero derivatives)
  bool has_sensor = false;   ///< whether any parameter is free

  std::vector<int> camera_of_pose;  ///< -1 = fixed
  std::vector<uint32_t> pose_of_camera;
  std::vector<Slot> slots;  ///< sorted by point
  std::vector<Point> points;
  std::vector<std::vector<uint32_t>> slots_of_pose;

  // Residuals and derivatives of all blocks, pose by pose, scaled by the square root of the robust weight
  // (zero if not in use): see linearize_block.
  RowLayout layout;
  std::vector<size_t> first_block;  ///< per pose
  std::vector<double> rows;
  std::vector<double> J_point;

  // Per slot.
  std::vector<Eigen::Matrix<double, kCameraDof, 3>> H_camera_point;

  std::vector<SensorPoint> H_sensor_point;  ///< per point; empty if the sensor is fixed
  BlockPattern pattern;  ///< of H_camera, including the fill-in from eliminating the points
  /// First entry of each camera in pattern.off_diagonal, which is sorted by column.
  std::vector<size_t> column_begin;
  BlockMatrix<kCameraDof> H_camera{pattern};
  CameraSensor H_camera_sensor;
  SensorMatrix H_sensor = SensorMatrix::Zero();
  Eigen::VectorXd g_camera;
  SensorVector g_sensor = SensorVector::Zero();

 private:
  /// Contribution of one pose's observations to the sensor block.
  struct SensorPart {
    SensorMatrix H = SensorMatrix::Zero();
    SensorVector g = SensorVector::Zero();
  };

  void number_unknowns();
  void make_rows();
  void make_pattern();
  SensorPart linearize_pose(size_t pose, const BundleState& state, const BundleView& view);
  void sum_point(Point& point);
  void add_priors(const BundleState& state);
};

}  // namespace kinloop
