#include "kinloop/sensor/sensor_model.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "kinloop/core/errors.hpp"

namespace kinloop {

const char* sensor_parameter_name(SensorParameter parameter) {
  static constexpr std::array<const char*, kSensorParameterCount> kNames = {
      "focal_x_px",      "focal_y_px",      "center_x_px",       "center_y_px",
      "radial_1",        "radial_2",        "rolling_shutter_s", "depth_time_s",
      "depth_shutter_s", "depth_scale",     "depth_offset",      "depth_offset_x",
      "depth_offset_y",  "depth_offset_xx", "depth_offset_xy",   "depth_offset_yy"};
  return kNames.at(static_cast<size_t>(parameter));
}

bool SensorCalibration::selects_parameters() const {
  return (std::isfinite(max_sigma_ratio) || min_sigmas > 0) && (prior_sigma.array() > 0).any();
}

bool SensorCalibration::accepts(int parameter, double estimated, double posterior_sigma) const {
  return posterior_sigma <= max_sigma_ratio * prior_sigma(parameter) &&
         std::abs(estimated - prior_mean(parameter)) >= min_sigmas * posterior_sigma;
}

Eigen::Vector2d corrected_pixel(const PinholeCamera& camera, const SensorVector& sensor,
                                const Eigen::Vector2d& ray) {
  const double r2 = ray.squaredNorm();
  const Eigen::Vector2d bent = ray * (1 + r2 * (sensor(kRadial1) + r2 * sensor(kRadial2)));
  return {(camera.fx + sensor(kFocalX)) * bent.x() + camera.cx + sensor(kCenterX),
          (camera.fy + sensor(kFocalY)) * bent.y() + camera.cy + sensor(kCenterY)};
}

Eigen::Vector2d corrected_ray(const PinholeCamera& camera, const SensorVector& sensor,
                              const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d bent((pixel.x() - camera.cx - sensor(kCenterX)) / (camera.fx + sensor(kFocalX)),
                             (pixel.y() - camera.cy - sensor(kCenterY)) / (camera.fy + sensor(kFocalY)));
  constexpr int kRounds = 10;  // corrections are small: each round gains more than a digit
  Eigen::Vector2d ray = bent;
  for (int round = 0; round < kRounds && !ray.isZero(0); ++round) {
    const double r2 = ray.squaredNorm();
    const Eigen::Vector2d next = bent / (1 + r2 * (sensor(kRadial1) + r2 * sensor(kRadial2)));
    if (next == ray) break;
    ray = next;
  }
  return ray;
}

Eigen::Matrix<double, 6, 1> inverse_depth_bias_basis(const PinholeCamera& camera,
                                                     const Eigen::Vector2d& pixel) {
  const double x = (pixel.x() - camera.cx) / camera.fx, y = (pixel.y() - camera.cy) / camera.fy;
  Eigen::Matrix<double, 6, 1> basis;
  basis << 1, x, y, x * x, x * y, y * y;
  return basis;
}

PinholeCamera corrected_camera(const PinholeCamera& camera, const SensorVector& correction) {
  PinholeCamera corrected = camera;
  corrected.fx += correction(kFocalX);
  corrected.fy += correction(kFocalY);
  corrected.cx += correction(kCenterX);
  corrected.cy += correction(kCenterY);
  // For given focal length and principal point, distortion is linear in its first coefficients.
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> H = Eigen::Matrix<double, 5, 5>::Zero();
  Vector5d g = Vector5d::Zero();
  constexpr int kSteps = 24;  // grid points of the fit along each side
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel((camera.width - 1) * i / static_cast<double>(kSteps),
                                  (camera.height - 1) * j / static_cast<double>(kSteps));
      const Eigen::Vector3d ray = camera.unproject(pixel, 1.0);
      const double x = ray.x(), y = ray.y();
      const Eigen::Vector2d raw = camera.distort(corrected_pixel(camera, correction, {x, y}));
      const auto [constant, along_x, along_y] = linear_distortion(camera.lens, {x, y});
      H += along_x * along_x.transpose() + along_y * along_y.transpose();
      g += along_x * ((raw.x() - corrected.cx) / corrected.fx - constant.x());
      g += along_y * ((raw.y() - corrected.cy) / corrected.fy - constant.y());
    }
  }
  set_linear_coefficients(corrected.lens, H.ldlt().solve(g));
  return corrected;
}

}  // namespace kinloop
