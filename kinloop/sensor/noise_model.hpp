#pragma once
// How much measurements deviate from the truth, and from which deviation on they count as outliers.

#include "kinloop/core/options.hpp"
#include "kinloop/sensor/depth_noise.hpp"

namespace kinloop {

/// Measurement noise, used by tracking, loop verification and bundle adjustment.
struct NoiseOptions {
  double inverse_depth_sigma_per_m = kKeypointInverseDepthSigmaPerM;
  double robust_width = kKeypointRobustWidth;
  double inlier_chi2_pixel = kChi2At95With2Dof;
  double inlier_chi2_depth = kChi2At95With1Dof;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(
        "inverse_depth_sigma_per_m", self.inverse_depth_sigma_per_m,
        "standard deviation of the inverse depth of a Kinect 1 at keypoints, 1/m; about four times that on "
        "planes, because keypoints lie on edges; that of another sensor (camera.yaml, sensor) is greater or "
        "smaller in the same ratio",
        Range{1e-6, 1});
    visit("robust_width", self.robust_width, "scale of the Huber loss, standard deviations", Range{0.1, 1e9});
    visit("inlier_chi2_pixel", self.inlier_chi2_pixel,
          "maximum squared pixel residual of an inlier (95 % of chi2, 2 DoF)", Range{0.1, 1e12}, Expert{});
    visit("inlier_chi2_depth", self.inlier_chi2_depth,
          "maximum squared depth residual; beyond it only the pixel is used (95 % of chi2, 1 DoF)",
          Range{0.1, 1e12}, Expert{});
  }
};

/// The noise of the measurements of one sensor, as every estimator uses it. The defaults are those of a
/// Kinect 1.
struct NoiseModel {
  DepthNoise plane = {};                                      ///< of depth on planes
  DepthNoise keypoint = {kKeypointInverseDepthSigmaPerM};     ///< of depth at keypoints
  DepthNoise point_pair = {kPointPairInverseDepthSigmaPerM};  ///< where depth alone decides on a motion
  DepthNoise surface = {};                                    ///< of the surfaces that ICP aligns
  double robust_width = kKeypointRobustWidth;    ///< scale of the Huber loss, standard deviations
  double inlier_chi2_pixel = kChi2At95With2Dof;  ///< maximum squared pixel residual of an inlier
  /// Maximum squared depth residual of an inlier; beyond it only the pixel is used.
  double inlier_chi2_depth = kChi2At95With1Dof;
};

/// Returns the noise of a sensor with the noise `plane` on planes. `options` sets that at keypoints, and
/// scales that of pairs of points and of surfaces in the same ratio.
NoiseModel make_noise_model(const NoiseOptions& options, const DepthNoise& plane);

}  // namespace kinloop
