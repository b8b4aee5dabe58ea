#pragma once
// Bundle adjustment: estimates keyframe poses, points and, optionally, sensor corrections from the
// observations of the points. See Triggs et al. 2000, "Bundle adjustment - a modern synthesis".
//
// Each camera row is exposed at its own time: the pose at a pixel is propagate_pose(T_world_camera, velocity,
// t) with t = row * readout time. The pose of its depth is the same at the time of the depth image.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "kinloop/core/options.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/keypoint_measurement.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Measurement of point `point` in keyframe `pose`.
struct BundleObservation : KeypointMeasurement {
  uint32_t pose = 0;
  uint32_t point = 0;
};

/// Input of bundle adjustment.
struct BundleProblem {
  /// The corrections are the start; those of constant parameters stay. The lens is ignored: pixels are
  /// undistorted.
  Sensor sensor;
  std::vector<SE3> T_world_camera;   ///< at the time of the middle row
  std::vector<uint8_t> fixed;        ///< 1 = the pose is constant; if empty, the first is constant
  std::vector<Velocity> velocities;  ///< constant velocity of each pose; if empty, zero
  std::vector<Eigen::Vector3d> p_world;
  std::vector<BundleObservation> observations;
  SensorPrior prior;  ///< of the corrections; by default all are constant
};

enum class BundleSolver { kBuiltin, kCeres };

constexpr auto option_names(BundleSolver) {
  return std::to_array<EnumName<BundleSolver>>(
      {{BundleSolver::kBuiltin, "builtin"}, {BundleSolver::kCeres, "ceres"}});
}

struct BundleOptions {
  BundleSolver solver = BundleSolver::kBuiltin;
  int rounds = 2;
  int max_iterations = 10;
  double tolerance = 1e-5;        ///< of the last round; earlier rounds only serve to find the outliers
  bool pose_covariances = false;  ///< compute the covariance of every pose
  int threads = 1;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("solver", self.solver, "solver");
    visit("rounds", self.rounds, "rounds of outlier reclassification", Range{1, 20}, Expert{});
    visit("max_iterations", self.max_iterations, "maximum Levenberg-Marquardt iterations per round",
          Range{1, 1000}, Expert{});
    visit("tolerance", self.tolerance, "function tolerance: relative cost decrease that ends a round",
          Range{0, 1}, Expert{});
    visit("threads", self.threads, "number of threads; the result does not depend on it", Range{1, 1024},
          Expert{});
  }
};

/// Result of bundle adjustment.
struct BundleSolution {
  std::vector<SE3> T_world_camera;
  std::vector<Eigen::Vector3d> p_world;
  std::vector<uint8_t> point_used;  ///< 0 = too few observations (one without depth, or only outliers)
  std::vector<uint8_t> outliers;    ///< 1 = pixel outlier (or a value that is not finite)
  SensorVector corrections = SensorVector::Zero();
  /// Zero rows for constant parameters. If parameters are selected, of all free ones at the selection.
  SensorMatrix sensor_covariance = SensorMatrix::Zero();
  SensorFlags sensor_free{};  ///< parameters that are free in the last round
  /// Marginal covariance of each pose T * exp(x), x = (translation [m]; rotation [rad]) in its own axes,
  /// given exact constant poses. Zero for constant poses; infinite diagonal for directions that nothing
  /// observes. Empty unless `pose_covariances` is set.
  std::vector<Matrix6d> pose_covariance;
  /// Variance of the noise of the pixels and depths in use, in that assumed: the sum of their squared
  /// residuals, without robust weights, over residuals less unknowns. 0 if unknown or `pose_covariances` is
  /// not set.
  double residual_variance = 0;
  /// How many residuals of a part of an image (a sixteenth of a square around it) tell as much as one whose
  /// error is independent: the squares of their sums over the sum of their squares, at least 1 (the design
  /// effect; Liang and Zeger 1986, "Longitudinal data analysis using generalized linear models").
  double residual_clustering = 1;
  double chi2_before = 0;  ///< robust cost at the start, over the final inliers
  double chi2_after = 0;   ///< robust cost at the end
  int iterations = 0;
  bool converged = false;
};

/// Adjusts poses, points and free sensor parameters. In degenerate problems, unconstrained points and
/// observations with values that are not finite are ignored and keep their input values. Throws
/// std::logic_error if indices are out of range or vector sizes disagree.
BundleSolution solve_bundle(const BundleProblem& problem, const BundleOptions& options);

}  // namespace kinloop
