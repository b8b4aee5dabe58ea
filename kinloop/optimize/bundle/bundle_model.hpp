#pragma once
// Residuals of bundle adjustment and their derivatives, shared by both solvers.

#include <array>
#include <vector>

#include <Eigen/Core>

#include "kinloop/optimize/bundle/bundle.hpp"
#include "kinloop/optimize/kernels/observation_block.hpp"

namespace kinloop {

/// The unknowns of bundle adjustment.
struct BundleState {
  std::vector<SE3> T_world_camera;
  std::vector<Eigen::Vector3d> p_world;
  SensorVector corrections = SensorVector::Zero();
};

/// The used parts of an observation.
enum class BundleUse : uint8_t { kNothing, kPixel, kPixelAndDepth };

/// Observations of one pose that are evaluated together.
struct BundleBlock {
  ObservationBlock measured;
  std::array<uint32_t, ObservationBlock::kSize> observations{};  ///< index in the problem
  std::array<uint32_t, ObservationBlock::kSize> points{};        ///< index in the problem
  size_t count = 0;
};

/// Memory that is reused from round to round.
struct BundleBuffers {
  std::vector<double> products;    ///< see PointProducts
  std::vector<double> eliminated;  ///< see eliminate_point
};

/// A problem reduced to its usable parts, as input of the solvers.
struct BundleTask {
  const BundleProblem& problem;
  const BundleOptions& options;
  std::vector<uint8_t> fixed;        ///< per pose; at least one is 1
  std::vector<Velocity> velocities;  ///< per pose
  std::vector<BundleUse> uses;       ///< per observation; a point with any use is constrained
  std::vector<std::vector<BundleBlock>> blocks_of_pose = {};  ///< all usable observations
  SensorPrior prior = {};                                     ///< without the parameters no longer free
  double tolerance = 0;                                       ///< of this round
  mutable BundleBuffers buffers = {};
};

/// Returns the sensor of a task with the corrections of a state.
Sensor sensor_at(const BundleTask& task, const BundleState& state);

/// Returns the views of all poses.
std::vector<BundleView> views_of(const BundleTask& task, const BundleState& state);

/// Returns a block with the points of a state and the current use of each observation.
ObservationBlock block_at(const BundleTask& task, const BundleBlock& block, const BundleState& state);

/// Returns 1 for each point with an observation in use.
std::vector<uint8_t> used_points(const BundleTask& task);

/// Normalised residuals (du, dv, inverse depth) of one observation and their derivatives with respect to x of
/// the pose T * exp(x), velocity, point and sensor corrections. Zero if the point is behind the camera; the
/// depth row is zero if depth is not used.
struct LinearizedObservation {
  bool seen = false;  ///< false if the point is behind the camera
  Eigen::Vector3d e;
  Eigen::Matrix<double, 3, 6> J_pose;
  Eigen::Matrix<double, 3, 6> J_velocity;
  Eigen::Matrix3d J_point;
  Eigen::Matrix<double, 3, kSensorParameterCount> J_sensor;
};
LinearizedObservation linearize_observation(const Sensor& sensor, const KeypointMeasurement& measured,
                                            BundleUse use, const BundleView& view,
                                            const Eigen::Vector3d& p_world);

/// Returns the robust cost of all observations in use and of the priors.
double bundle_cost(const BundleTask& task, const BundleState& state);

/// Result of one round of a solver.
struct BundleRoundResult {
  BundleState state;
  int iterations = 0;
  bool converged = false;
};

/// Minimize the cost from `state` with the built-in solver and with Ceres.
BundleRoundResult minimize_builtin(const BundleTask& task, const BundleState& state);
BundleRoundResult minimize_with_ceres(const BundleTask& task, const BundleState& state);

/// Covariance of the parameters at a minimum.
struct BundleCovariance {
  SensorMatrix sensor = SensorMatrix::Zero();
  std::vector<Matrix6d> poses;  ///< empty unless requested
};
BundleCovariance bundle_covariance(const BundleTask& task, const BundleState& state);

/// A linear step from `state` that takes the rejected parameters to their prior means, given the covariance
/// of all, and everything else to the minimum for that.
struct BundleSelection {
  SensorMatrix covariance = SensorMatrix::Zero();
  SensorPrior prior;  ///< the rejected parameters are constant
  BundleState state;
};
BundleSelection select_sensor_parameters(const BundleTask& task, const BundleState& state);

}  // namespace kinloop
