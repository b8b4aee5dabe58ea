#pragma once
// In: a RealSense's distortion. Out: Brown-Conrady coefficients with the same effect over the image.

#include <array>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// The two variants of librealsense: `kInverse` maps distorted to undistorted coordinates; `kModified`
/// multiplies the tangential part with the radial factor.
enum class RealsenseLens { kInverse, kModified };

/// Fits k1, k2, p1, p2, k3 by least squares over the pixels of `camera`, whose own distortion is ignored.
std::array<double, 5> brown_conrady_from(RealsenseLens lens, const std::array<double, 5>& coefficients,
                                         const PinholeCamera& camera);

}  // namespace kinloop
