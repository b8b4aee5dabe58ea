#include "kinloop/features/keypoint_measurements.hpp"

namespace kinloop {

KeypointMeasurement compensated_measurement(const Features& features, size_t index) {
  KeypointMeasurement measured;
  measured.pixel = features.pixels[index].cast<double>();
  measured.depth_m = static_cast<double>(features.depths_m[index]);
  measured.sigma_px = static_cast<double>(features.sigmas_px[index]);
  return measured;
}

KeypointMeasurement raw_measurement(const Features& features, size_t index, int image_height_px) {
  KeypointMeasurement measured;
  measured.pixel = features.measured_pixels[index].cast<double>();
  measured.depth_m = static_cast<double>(features.measured_depths_m[index]);
  measured.sigma_px = static_cast<double>(features.sigmas_px[index]);
  measured.row = static_cast<double>(features.raw_pixels[index].y()) / image_height_px - 0.5;
  measured.depth_stamp_difference_s = static_cast<double>(features.depth_stamp_difference_s);
  if (!features.inverse_depth_gradients.empty()) {
    measured.inverse_depth_gradient = features.inverse_depth_gradients[index].cast<double>();
  }
  return measured;
}

}  // namespace kinloop
