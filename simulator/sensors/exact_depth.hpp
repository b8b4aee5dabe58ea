#pragma once
// What the depth sensor models measure, and the shadow that all sensors with a baseline have.

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace kinloop::sim {

/// Exact depth of every pixel, the cosine of its incidence angle (0 if the surface returns no depth) and the
/// share of infrared light that the surface reflects (empty where no model asks for it): 32FC1, or 32FC4 for
/// four samples within each pixel.
struct ExactDepth {
  cv::Mat depth_m, cosine, reflectance = {};
};

/// Marks the pixels of a row that the projector or second camera, right of the camera, cannot see: scanning
/// leftwards, a point is in shadow if its column there, x - disparity, is not left of all previous ones. The
/// disparity is `disparity_scale` / depth.
void cast_shadow(const float* depth_m, int width, double disparity_scale, std::vector<uint8_t>& shadow);

/// Probability of losing depth by incidence angle: 0 up to 72 degrees, 1 beyond 83.
double grazing_loss(float cosine);

}  // namespace kinloop::sim
