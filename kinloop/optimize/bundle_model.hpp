#pragma once
// The residuals of bundle adjustment with their derivatives: what both solvers share.

#include <vector>

#include <Eigen/Core>

#include "kinloop/optimize/bundle.hpp"

namespace kinloop {

/// What adjustment changes.
struct BundleState {
  std::vector<SE3> T_world_camera;
  std::vector<Velocity> velocities;
  std::vector<Eigen::Vector3d> p_world;
  SensorVector sensor = SensorVector::Zero();
};

/// What of an observation is used.
enum class BundleUse : uint8_t { kNothing, kPixel, kPixelAndDepth };

/// A problem cleared of what cannot be used, for the solvers.
struct BundleTask {
  const BundleProblem& problem;
  const BundleOptions& options;
  std::vector<uint8_t> fixed;        ///< of each pose, at least one
  std::vector<Velocity> velocities;  ///< of each pose, as given
  std::vector<BundleUse> uses;       ///< of each observation; a point with any use is constrained
};

/// Normalised residual (du, dv, inverse depth) of one observation.
struct BundleResidual {
  Eigen::Vector3d e = Eigen::Vector3d::Zero();  ///< e.z() = 0 where depth is not used
  bool seen = false;                            ///< false where the point is behind the camera

  [[nodiscard]] double pixel_squared() const { return e.head<2>().squaredNorm(); }
  [[nodiscard]] double depth_squared() const { return e.z() * e.z(); }
};

/// Its derivatives, by x of the pose T * exp(x), by velocity, point and sensor corrections.
struct BundleJacobian {
  Eigen::Matrix<double, 3, 6> pose;
  Eigen::Matrix<double, 3, 6> velocity;
  Eigen::Matrix3d point;
  Eigen::Matrix<double, 3, kSensorParameterCount> sensor;
};

/// The squared residual that stands for a point behind the camera.
constexpr double kUnseenSquared = 1e6;

/// The pose of a keyframe in the form that the many observations of it need.
struct BundleView {
  Eigen::Matrix3d R_camera_world;
  Eigen::Vector3d center;
  Velocity velocity;

  BundleView(const SE3& T_world_camera, const Velocity& v)
      : R_camera_world(T_world_camera.R().transpose()), center(T_world_camera.translation), velocity(v) {}
};

/// The views of all poses.
std::vector<BundleView> views_of(const BundleState& state);

/// Residual of an observation.
BundleResidual bundle_residual(const BundleTask& task, const BundleObservation& observation, BundleUse use,
                               const BundleView& view, const Eigen::Vector3d& p_world,
                               const SensorVector& sensor);

/// Derivatives that not every solver needs.
struct BundleDerivatives {
  bool velocity = true;
  bool sensor = true;
};

/// A residual with its derivatives: where it is seen, those that are wanted are set.
struct LinearizedObservation {
  BundleResidual residual;
  BundleJacobian jacobian;
};
LinearizedObservation linearize_observation(const BundleTask& task, const BundleObservation& observation,
                                            BundleUse use, const BundleView& view,
                                            const Eigen::Vector3d& p_world, const SensorVector& sensor,
                                            const BundleDerivatives& wanted = {});

/// Error of a measured motion, (translation; rotation vector) of T_a_b^-1 * (T_world_a^-1 * T_world_b), and
/// its derivatives by x of either pose T * exp(x).
struct LinearizedEdge {
  Vector6d e;
  Matrix6d by_a, by_b;
};
LinearizedEdge linearize_bundle_edge(const BundleEdge& edge, const SE3& T_world_a, const SE3& T_world_b);

/// Inverse variances of the prior on a velocity.
Vector6d velocity_information(const BundleOptions& options);

/// Indices of the sensor parameters that are free.
std::vector<int> free_sensor_parameters(const SensorCalibration& sensor);

/// Inverse variance of the prior on a free sensor parameter, 0 without one.
double sensor_information(const SensorCalibration& sensor, int parameter);

/// The robust cost of all in use: observations, edges and priors.
double bundle_cost(const BundleTask& task, const BundleState& state);

/// What one round of a solver gives.
struct BundleRound {
  BundleState state;
  int iterations = 0;
  bool converged = false;
};

/// Least cost from `state` by the built-in solver and by Ceres.
BundleRound minimize_builtin(const BundleTask& task, const BundleState& state);
BundleRound minimize_with_ceres(const BundleTask& task, const BundleState& state);

/// How well the parameters are known at a minimum.
struct BundleCovariance {
  SensorMatrix sensor = SensorMatrix::Zero();
  std::vector<Matrix6d> poses;  ///< empty unless asked for
};
BundleCovariance bundle_covariance(const BundleTask& task, const BundleState& state);

}  // namespace kinloop
