#pragma once
// In: points of a reference frame, each with the pixel (and perhaps the depth) at which a camera sees it, and
// a guess of the camera's pose. Out: the pose, which observations agree with it, and how well it is known.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "kinloop/base/options.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/depth_noise.hpp"
#include "kinloop/geometry/keypoint_measurement.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// A point of the reference frame as the camera measured it.
struct PoseObservation : KeypointMeasurement {
  Eigen::Vector3d p_reference = Eigen::Vector3d::Zero();  ///< m
};

/// `robust_width`, `inlier_chi2_...` and `inverse_depth_sigma_per_m` describe the measurements: Slam sets
/// them from SlamOptions::noise.
struct AbsolutePoseOptions {
  int rounds = 4;
  int max_iterations = 8;
  double robust_width = kKeypointRobustWidth;    ///< scale of the Huber loss, standard deviations
  double inlier_chi2_pixel = kChi2At95With2Dof;  ///< maximum squared pixel residual of an inlier
  double inlier_chi2_depth =
      kChi2At95With1Dof;  ///< maximum squared depth residual; beyond it only the pixel is used
  double inverse_depth_sigma_per_m = kKeypointInverseDepthSigmaPerM;
  int min_inliers = 6;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("rounds", self.rounds, "rounds of outlier reclassification", Range{1, 20});
    visit("max_iterations", self.max_iterations, "maximum Gauss-Newton iterations per round", Range{1, 100});
    visit("min_inliers", self.min_inliers, "minimum number of inliers", Range{3, 1000});
  }
};

/// A camera pose with its support.
struct AbsolutePoseSolution {
  SE3 T_reference_camera;
  std::vector<uint8_t> inliers;  ///< 1 where the observation agrees
  int inlier_count = 0;
  Matrix6d information = Matrix6d::Zero();  ///< of T * exp(x), x = (translation; rotation)
  double chi2 = 0;                          ///< sum of squared normalised residuals of the inliers
};

/// The pose near `T_reference_camera_guess` that agrees best with the observations (robust Gauss-Newton).
/// Nothing where fewer than `min_inliers` agree or they leave some direction of the pose open. Observations
/// with a number that is not finite are outliers. Pixel and depth are robust each for itself: a keypoint at
/// the edge of a surface has a good pixel and may have the depth of the wrong side.
std::optional<AbsolutePoseSolution> solve_absolute_pose(const PinholeCamera& camera,
                                                        std::span<const PoseObservation> observations,
                                                        const SE3& T_reference_camera_guess,
                                                        const AbsolutePoseOptions& options);

/// 1 where an observation's pixel agrees with the pose; depth is not asked.
std::vector<uint8_t> pixel_inliers(const PinholeCamera& camera, std::span<const PoseObservation> observations,
                                   const SE3& T_reference_camera, const AbsolutePoseOptions& options);

}  // namespace kinloop
