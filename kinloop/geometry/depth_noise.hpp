#pragma once
// Standard deviation of measured depth. It is constant in inverse depth: sigma_z = sigma z^2.

namespace kinloop {

/// Standard deviation of the inverse depth of a Kinect 1 on a plane, 1/m (Khoshelham and Elberink 2012).
inline constexpr double kSensorInverseDepthSigmaPerM = 1.425e-3;

/// The same at keypoints: about four times that of the sensor, because keypoints lie on edges.
inline constexpr double kKeypointInverseDepthSigmaPerM = 6e-3;

/// The same where pairs of 3D points decide on a motion by their depth alone: a wider one lets false pairs
/// pass.
inline constexpr double kPointPairInverseDepthSigmaPerM = 2 * kSensorInverseDepthSigmaPerM;

/// Scale of Huber's loss on keypoints, standard deviations. Nearly least absolute deviations: wrong depths at
/// the edges of objects are many and one-sided.
inline constexpr double kKeypointRobustWidth = 0.5;

/// 95 % of chi2 with one, two and three degrees of freedom.
inline constexpr double kChi2At95With1Dof = 3.841, kChi2At95With2Dof = 5.991, kChi2At95With3Dof = 7.815;

/// Axial noise of a structured-light camera: it triangulates, so disparity noise is constant and depth noise
/// grows with the square of the distance.
struct DepthNoise {
  double coefficient_per_m = kSensorInverseDepthSigmaPerM;

  [[nodiscard]] double sigma_m(double depth_m) const { return coefficient_per_m * depth_m * depth_m; }
};

}  // namespace kinloop
