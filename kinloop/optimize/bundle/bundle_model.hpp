#pragma once
// The residuals of bundle adjustment with their derivatives: what both solvers share.

#include <array>
#include <vector>

#include <Eigen/Core>

#include "kinloop/optimize/bundle/bundle.hpp"
#include "kinloop/optimize/kernels/observation_block.hpp"

namespace kinloop {

/// What adjustment changes.
struct BundleState {
  std::vector<SE3> T_world_camera;
  std::vector<Eigen::Vector3d> p_world;
  SensorVector sensor = SensorVector::Zero();
};

/// What of an observation is used.
enum class BundleUse : uint8_t { kNothing, kPixel, kPixelAndDepth };

/// Observations of one pose that are evaluated together, as they were measured.
struct BundleBlock {
  ObservationBlock measured;
  std::array<uint32_t, ObservationBlock::kSize> observations{};  ///< in the problem
  size_t count = 0;
};

/// A problem cleared of what cannot be used, for the solvers.
struct BundleTask {
  const BundleProblem& problem;
  const BundleOptions& options;
  std::vector<uint8_t> fixed;        ///< of each pose, at least one
  std::vector<Velocity> velocities;  ///< of each pose, as given
  std::vector<BundleUse> uses;       ///< of each observation; a point with any use is constrained
  std::vector<std::vector<BundleBlock>> blocks_of_pose = {};  ///< all observations that could be used
};

/// The camera, the sensor and the weights of a task.
MeasurementModel measurement_model(const BundleTask& task, const SensorVector& sensor);

/// The views of all poses.
std::vector<BundleView> views_of(const BundleTask& task, const BundleState& state);

/// A block as measured, with the points of a state and what of it is in use.
ObservationBlock block_at(const BundleTask& task, const BundleBlock& block, const BundleState& state);

/// Normalised residuals (du, dv, inverse depth) of one observation and their derivatives by x of the pose
/// T * exp(x), by velocity, point and sensor corrections; zero where the point is behind the camera, and
/// those of depth where it is not used.
struct LinearizedObservation {
  bool seen = false;  ///< false where the point is behind the camera
  Eigen::Vector3d e;
  Eigen::Matrix<double, 3, 6> J_pose;
  Eigen::Matrix<double, 3, 6> J_velocity;
  Eigen::Matrix3d J_point;
  Eigen::Matrix<double, 3, kSensorParameterCount> J_sensor;
};
LinearizedObservation linearize_observation(const BundleTask& task, const KeypointMeasurement& measured,
                                            BundleUse use, const BundleView& view,
                                            const Eigen::Vector3d& p_world, const SensorVector& sensor);

/// Indices of the sensor parameters that are free.
std::vector<int> free_sensor_parameters(const SensorCalibration& sensor);

/// Inverse variance of the prior on a free sensor parameter, 0 without one.
double sensor_information(const SensorCalibration& sensor, int parameter);

/// The robust cost of all in use: observations and priors.
double bundle_cost(const BundleTask& task, const BundleState& state);

/// What one round of a solver gives.
struct BundleRoundResult {
  BundleState state;
  int iterations = 0;
  bool converged = false;
};

/// Least cost from `state` by the built-in solver and by Ceres.
BundleRoundResult minimize_builtin(const BundleTask& task, const BundleState& state);
BundleRoundResult minimize_with_ceres(const BundleTask& task, const BundleState& state);

/// How well the parameters are known at a minimum.
struct BundleCovariance {
  SensorMatrix sensor = SensorMatrix::Zero();
  std::vector<Matrix6d> poses;  ///< empty unless asked for
};
BundleCovariance bundle_covariance(const BundleTask& task, const BundleState& state);

}  // namespace kinloop
