#pragma once
// In: a RealSense's distortion. Out: Brown-Conrady coefficients with the same effect over the image.

#include <array>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// Fits k1, k2, p1, p2, k3 to librealsense's modified Brown-Conrady model, which multiplies the tangential
/// part with the radial factor, by least squares over the pixels of `camera`, whose own distortion is
/// ignored.
std::array<double, 5> brown_conrady_from_modified(const std::array<double, 5>& coefficients,
                                                  const PinholeCamera& camera);

}  // namespace kinloop
