#pragma once
// Standard deviation of measured depth.

namespace kinloop {

/// Axial noise of a structured-light camera: it triangulates, so disparity noise is constant and depth noise
/// grows with the square of the distance (Khoshelham and Elberink 2012: sigma_z = 1.425e-3 z^2 m).
struct DepthNoise {
  double coefficient_per_m = 1.425e-3;

  [[nodiscard]] double sigma_m(double depth_m) const { return coefficient_per_m * depth_m * depth_m; }
};

}  // namespace kinloop
