#include "kinloop/tracking/motion_compensation.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "kinloop/features/keypoint_measurements.hpp"

namespace kinloop {
namespace {

/// Returns the point in camera axes at the frame's stamp. The point lies on the ray of its pixel at the time
/// of its row, at the distance consistent with the depth measured at the time of the depth image.
Eigen::Vector3d deskew_point(const KeypointMeasurement& m, const PinholeCamera& camera,
                             const SensorVector& sensor, const Velocity& velocity) {
  const double color_time_s = sensor(kRollingShutter) * m.row;
  const bool has_slope = m.inverse_depth_gradient.allFinite();
  const double depth_time_s =
      m.depth_stamp_difference_s + sensor(kDepthDelay) + sensor(kDepthShutter) * m.row;
  const Eigen::Vector3d ray = corrected_ray(camera, sensor, m.pixel).homogeneous();
  const double inverse_depth =
      (1 + sensor(kDepthScale)) / m.depth_m +
      sensor.segment<6>(kInverseDepthBias).dot(inverse_depth_bias_basis(camera, m.pixel));
  constexpr int kRounds = 3;  // converges at once: the two times differ by a fraction of a frame
  double z = 1 / inverse_depth;
  Eigen::Vector3d p = point_in_earlier_camera(z * ray, velocity, color_time_s);
  if (!has_slope) return p;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector3d p_at_depth = point_in_later_camera(p, velocity, depth_time_s);
    if (!(p_at_depth.z() > 0)) break;
    const Eigen::Vector2d pixel_at_depth = corrected_pixel(camera, sensor, p_at_depth.hnormalized());
    const double expected = inverse_depth + m.inverse_depth_gradient.dot(pixel_at_depth - m.pixel);
    if (!(expected > 0)) break;
    z += 1 / expected - p_at_depth.z();
    p = point_in_earlier_camera(z * ray, velocity, color_time_s);
  }
  return p;
}

}  // namespace

bool needs_deskewing(const Features& features, const SensorVector& sensor) {
  return features.depth_stamp_difference_s != 0 || !sensor.isZero(0);
}

Features deskew_features(const Features& features, const PinholeCamera& camera, const SensorVector& sensor,
                         const Velocity& velocity) {
  Features deskewed = features;
  const Velocity turning{Eigen::Vector3d::Zero(), velocity.angular_rad_s};
  for (size_t i = 0; i < features.size(); ++i) {
    const KeypointMeasurement m = raw_measurement(features, i, camera.height);
    const bool has_depth = m.depth_m > 0;
    const Eigen::Vector3d p =
        has_depth ? deskew_point(m, camera, sensor, velocity)
                  : point_in_earlier_camera(corrected_ray(camera, sensor, m.pixel).homogeneous(), turning,
                                            sensor(kRollingShutter) * m.row);
    if (!(p.z() > 0)) continue;
    deskewed.pixels[i] = camera.project(p).cast<float>();
    deskewed.depths_m[i] = has_depth ? static_cast<float>(p.z()) : 0.0F;
  }
  return deskewed;
}

std::optional<Eigen::Vector2d> raw_pixel_of(const Eigen::Vector3d& p_camera, const PinholeCamera& camera,
                                            const SensorVector& sensor, const Velocity& velocity) {
  constexpr int kRounds = 2;  // the row changes by far less than the image during its readout
  const bool rolling = sensor(kRollingShutter) != 0;
  Eigen::Vector3d p = p_camera;
  for (int round = 0;; ++round) {
    if (!(p.z() > 0)) return std::nullopt;
    const Eigen::Vector2d raw = camera.distort(corrected_pixel(camera, sensor, p.hnormalized()));
    if (!rolling || round == kRounds) return raw;
    const double row = std::clamp(raw.y() / camera.height - 0.5, -0.5, 0.5);
    p = point_in_later_camera(p_camera, velocity, sensor(kRollingShutter) * row);
  }
}

}  // namespace kinloop
