#pragma once
// In: keyframe poses, points, and where the keyframes see the points. Out: the poses, points and, where
// asked, corrections of the sensor under which the observations agree best. See Triggs et al. 2000, "Bundle
// adjustment - a modern synthesis".
//
// A camera row is exposed at its own time, so the pose that sees a pixel is propagate_pose(T_world_camera,
// velocity, t) with t = row * rolling shutter, and the pose that measured its depth is the same with the time
// of the depth image.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "kinloop/base/options.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/depth_noise.hpp"
#include "kinloop/geometry/keypoint_measurement.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/optimize/bundle/sensor_model.hpp"

namespace kinloop {

/// Point `point` as keyframe `pose` measured it.
struct BundleObservation : KeypointMeasurement {
  uint32_t pose = 0;
  uint32_t point = 0;
};

/// Everything that adjustment needs, as plain values.
struct BundleProblem {
  PinholeCamera camera;              ///< its distortion is not used: pixels are undistorted
  std::vector<SE3> T_world_camera;   ///< at the time of the middle row
  std::vector<uint8_t> fixed;        ///< 1 = the pose is held; may be empty: the first is held
  std::vector<Velocity> velocities;  ///< of each pose, held; may be empty: zero
  std::vector<Eigen::Vector3d> p_world;
  std::vector<BundleObservation> observations;
  SensorCalibration sensor;
};

enum class BundleSolver { kBuiltin, kCeres };

constexpr auto option_names(BundleSolver) {
  return std::to_array<EnumName<BundleSolver>>(
      {{BundleSolver::kBuiltin, "builtin"}, {BundleSolver::kCeres, "ceres"}});
}

/// `robust_width`, `inlier_chi2_...` and `inverse_depth_sigma_per_m` describe the measurements: Slam sets
/// them from SlamOptions::noise.
struct BundleOptions {
  BundleSolver solver = BundleSolver::kBuiltin;
  int rounds = 2;
  int max_iterations = 10;
  double tolerance = 1e-5;
  double robust_width = kKeypointRobustWidth;    ///< scale of the Huber loss, standard deviations
  double inlier_chi2_pixel = kChi2At95With2Dof;  ///< maximum squared pixel residual of an inlier
  double inlier_chi2_depth = kChi2At95With1Dof;  ///< maximum squared depth residual
  double inverse_depth_sigma_per_m = kKeypointInverseDepthSigmaPerM;
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

/// What adjustment found.
struct BundleSolution {
  std::vector<SE3> T_world_camera;
  std::vector<Eigen::Vector3d> p_world;
  std::vector<uint8_t> point_used;  ///< 0 = too little was seen of it (once without depth, or only outliers)
  std::vector<uint8_t> outliers;    ///< 1 = the pixel disagrees (or a number of it is not finite)
  SensorVector sensor = SensorVector::Zero();
  SensorMatrix sensor_covariance = SensorMatrix::Zero();  ///< zero rows for parameters held fixed
  /// Of each pose T * exp(x), x = (translation; rotation) in its own axes, with everything else that is free
  /// (poses, points, sensor) unknown and the fixed poses exact: zero for these, an infinite
  /// diagonal for what nothing observes. Empty unless `pose_covariances` asks for it.
  std::vector<Matrix6d> pose_covariance;
  double chi2_before = 0;  ///< robust cost of what counts in the end (no outliers), at the start
  double chi2_after = 0;   ///< and at the end
  int iterations = 0;
  bool converged = false;
};

/// Adjusts poses, points and the free sensor parameters. A degenerate problem is answered by what is given:
/// points that nothing constrains and observations with numbers that are not finite are left out.
/// Throws std::logic_error when indices point outside or vectors disagree in size.
BundleSolution solve_bundle(const BundleProblem& problem, const BundleOptions& options);

}  // namespace kinloop
