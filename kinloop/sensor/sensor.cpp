#include "kinloop/sensor/sensor.hpp"

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace kinloop {

Sensor make_sensor(const RgbdCamera& camera, const NoiseOptions& noise) {
  Sensor sensor{camera.color, make_noise_model(noise, camera.sensor.noise)};
  const double readout_s = nominal_readout_s(camera);
  sensor.corrections(kRollingShutter) = readout_s;
  if (camera.sensor.kind == DepthSensorKind::kStructuredLight) sensor.corrections(kDepthShutter) = readout_s;
  sensor.corrections(kDepthDelay) = camera.depth_delay_s;
  return sensor;
}

Sensor without_corrections(Sensor sensor) {
  sensor.corrections.setZero();
  return sensor;
}

Eigen::Vector2d corrected_pixel(const Sensor& sensor, const Eigen::Vector2d& ray) {
  const PinholeCamera& camera = sensor.camera;
  const SensorVector& s = sensor.corrections;
  const double r2 = ray.squaredNorm();
  const Eigen::Vector2d distorted = ray * (1 + r2 * (s(kRadial1) + r2 * s(kRadial2)));
  return {(camera.fx + s(kFocalX)) * distorted.x() + camera.cx + s(kCenterX),
          (camera.fy + s(kFocalY)) * distorted.y() + camera.cy + s(kCenterY)};
}

Eigen::Vector2d corrected_ray(const Sensor& sensor, const Eigen::Vector2d& pixel) {
  const PinholeCamera& camera = sensor.camera;
  const SensorVector& s = sensor.corrections;
  const Eigen::Vector2d distorted((pixel.x() - camera.cx - s(kCenterX)) / (camera.fx + s(kFocalX)),
                                  (pixel.y() - camera.cy - s(kCenterY)) / (camera.fy + s(kFocalY)));
  constexpr int kRounds = 10;  // corrections are small: each round gains more than a digit
  Eigen::Vector2d ray = distorted;
  for (int round = 0; round < kRounds && !ray.isZero(0); ++round) {
    const double r2 = ray.squaredNorm();
    const Eigen::Vector2d next = distorted / (1 + r2 * (s(kRadial1) + r2 * s(kRadial2)));
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

PinholeCamera corrected_camera(const Sensor& sensor) {
  const PinholeCamera& camera = sensor.camera;
  PinholeCamera corrected = camera;
  corrected.fx += sensor.corrections(kFocalX);
  corrected.fy += sensor.corrections(kFocalY);
  corrected.cx += sensor.corrections(kCenterX);
  corrected.cy += sensor.corrections(kCenterY);
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
      const Eigen::Vector2d raw = camera.distort(corrected_pixel(sensor, {x, y}));
      const auto [constant, along_x, along_y] = linear_distortion(camera.lens, {x, y});
      H += along_x * along_x.transpose() + along_y * along_y.transpose();
      g += along_x * ((raw.x() - corrected.cx) / corrected.fx - constant.x());
      g += along_y * ((raw.y() - corrected.cy) / corrected.fy - constant.y());
    }
  }
  set_linear_coefficients(corrected.lens, H.ldlt().solve(g));
  return corrected;
}

double color_time_s(const Sensor& sensor, double row) {
  return sensor.corrections(kRollingShutter) * row;
}

double depth_time_s(const Sensor& sensor, const KeypointMeasurement& measured) {
  return measured.depth_stamp_difference_s + sensor.corrections(kDepthDelay) +
         sensor.corrections(kDepthShutter) * measured.row;
}

std::optional<Eigen::Vector2d> raw_pixel_of(const Sensor& sensor, const Eigen::Vector3d& p_camera,
                                            const Velocity& velocity) {
  constexpr int kRounds = 2;  // the row changes by far less than the image during its readout
  const bool rolling = sensor.corrections(kRollingShutter) != 0;
  Eigen::Vector3d p = p_camera;
  for (int round = 0;; ++round) {
    if (!(p.z() > 0)) return std::nullopt;
    const Eigen::Vector2d raw = sensor.camera.distort(corrected_pixel(sensor, p.hnormalized()));
    if (!rolling || round == kRounds) return raw;
    const double row = std::clamp(raw.y() / sensor.camera.height - 0.5, -0.5, 0.5);
    p = point_in_later_camera(p_camera, velocity, color_time_s(sensor, row));
  }
}

}  // namespace kinloop
