#include "kinloop/sensor/sensor_model.hpp"

#include <cmath>

namespace kinloop {

const char* sensor_parameter_name(SensorParameter parameter) {
  static constexpr std::array<const char*, kSensorParameterCount> kNames = {
      "focal_x_px",      "focal_y_px",      "center_x_px",       "center_y_px",
      "radial_1",        "radial_2",        "rolling_shutter_s", "depth_time_s",
      "depth_shutter_s", "depth_scale",     "depth_offset",      "depth_offset_x",
      "depth_offset_y",  "depth_offset_xx", "depth_offset_xy",   "depth_offset_yy"};
  return kNames.at(static_cast<size_t>(parameter));
}

bool SensorPrior::selects_parameters() const {
  return (std::isfinite(max_sigma_ratio) || min_sigmas > 0) && (sigma.array() > 0).any();
}

bool SensorPrior::accepts(int parameter, double estimated, double posterior_sigma) const {
  return posterior_sigma <= max_sigma_ratio * sigma(parameter) &&
         (typical.at(static_cast<size_t>(parameter)) ||
          std::abs(estimated - mean(parameter)) >= min_sigmas * posterior_sigma);
}

std::vector<int> SensorPrior::free_parameters() const {
  std::vector<int> free;
  for (int i = 0; i < kSensorParameterCount; ++i) {
    if (sigma(i) > 0) free.push_back(i);
  }
  return free;
}

double SensorPrior::information(int parameter) const {
  const double s = sigma(parameter);
  return std::isfinite(s) ? 1.0 / (s * s) : 0.0;
}

}  // namespace kinloop
