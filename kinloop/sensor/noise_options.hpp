#pragma once

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

/// Returns the noise of depth at keypoints, for a sensor with `sensor_noise` on planes.
DepthNoise keypoint_noise(const NoiseOptions& noise, const DepthNoise& sensor_noise);

}  // namespace kinloop
