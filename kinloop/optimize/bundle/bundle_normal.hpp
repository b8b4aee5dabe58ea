#pragma once
// The normal equations of bundle adjustment, block by block. Unknowns: free keyframes (blocks of 6), the
// sensor, points.
//
// Every sum is made by one thread in a fixed order (points by their observations, keyframes by theirs), so
// the result does not depend on the number of threads.

#include <vector>

#include "kinloop/optimize/bundle/bundle_model.hpp"
#include "kinloop/optimize/pose_graph/sparse_cholesky.hpp"

namespace kinloop {

/// H x = -g for all unknowns x; H = J' J, g = J' e, each observation weighted by its robust weight.
struct BundleNormalEquations {
  static constexpr int kCameraDof = 6;  ///< of a camera: its pose
  static constexpr int kSensor = kSensorParameterCount;
  using Block = Eigen::Matrix<double, kCameraDof, kCameraDof>;
  using CameraVector = Eigen::Matrix<double, kCameraDof, 1>;
  using SensorPoint = Eigen::Matrix<double, kSensor, 3>;
  using CameraSensor = Eigen::Matrix<double, Eigen::Dynamic, kSensor>;

  /// One observation in use.
  struct Slot {
    uint32_t observation = 0;  ///< in the problem
    int camera = -1;           ///< unknown, -1 = held
    uint32_t point = 0;        ///< unknown
    size_t place = 0;          ///< of its rows
  };
  struct Point {
    uint32_t id = 0;             ///< in the problem
    size_t first = 0, last = 0;  ///< its slots
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
  };

  /// Numbers the unknowns and finds which are coupled.
  explicit BundleNormalEquations(const BundleTask& task);

  /// Fills in the values at `state`.
  void linearize(const BundleState& state);

  const BundleTask& task;
  SensorVector sensor_free;  ///< 1 = free, 0 = held: its derivatives are zero
  bool has_sensor = false;   ///< whether any is free

  std::vector<int> camera_of_pose;  ///< -1 = held
  std::vector<uint32_t> pose_of_camera;
  std::vector<Slot> slots;  ///< by point
  std::vector<Point> points;
  std::vector<std::vector<uint32_t>> slots_of_pose;

  // Residuals and derivatives, times the root of the robust weight, of all blocks of all poses one after the
  // other (what is not in use is zero): see linearize_block.
  RowLayout layout;
  std::vector<size_t> first_block;  ///< of each pose
  std::vector<double> rows;
  std::vector<double> J_point;

  // Of each slot.
  std::vector<Eigen::Matrix<double, kCameraDof, 3>> H_camera_point;

  std::vector<SensorPoint> H_sensor_point;  ///< of each point; empty if the sensor is held
  BlockPattern pattern;              ///< of H_camera, with room for what eliminating the points fills in
  std::vector<size_t> column_begin;  ///< of each camera in pattern.off_diagonal, which goes column by column
  BlockMatrix<kCameraDof> H_camera{pattern};
  CameraSensor H_camera_sensor;
  SensorMatrix H_sensor = SensorMatrix::Zero();
  Eigen::VectorXd g_camera;
  SensorVector g_sensor = SensorVector::Zero();

 private:
  /// What the observations of one pose say of the sensor.
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
