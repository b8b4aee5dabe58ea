#include "kinloop/tracking/motion/motion_compensation.hpp"

#include <Eigen/Geometry>

#include "kinloop/features/keypoint_measurements.hpp"

namespace kinloop {
namespace {

/// Returns the point in camera axes at the frame's stamp. The point lies on the ray of its pixel at the time
/// of its row, at the distance consistent with the depth measured at the time of the depth image.
Eigen::Vector3d deskew_point(const KeypointMeasurement& m, const Sensor& sensor, const Velocity& velocity) {
  const SensorVector& s = sensor.corrections;
  const double color_s = color_time_s(sensor, m.row), depth_s = depth_time_s(sensor, m);
  const bool has_slope = m.inverse_depth_gradient.allFinite();
  const Eigen::Vector3d ray = corrected_ray(sensor, m.pixel).homogeneous();
  const double inverse_depth =
      (1 + s(kDepthScale)) / m.depth_m +
      s.segment<6>(kInverseDepthBias).dot(inverse_depth_bias_basis(sensor.camera, m.pixel));
  constexpr int kRounds = 3;  // converges at once: the two times differ by a fraction of a frame
  double z = 1 / inverse_depth;
  Eigen::Vector3d p = point_in_earlier_camera(z * ray, velocity, color_s);
  if (!has_slope) return p;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector3d p_at_depth = point_in_later_camera(p, velocity, depth_s);
    if (!(p_at_depth.z() > 0)) break;
    const Eigen::Vector2d pixel_at_depth = corrected_pixel(sensor, p_at_depth.hnormalized());
    const double expected = inverse_depth + m.inverse_depth_gradient.dot(pixel_at_depth - m.pixel);
    if (!(expected > 0)) break;
    z += 1 / expected - p_at_depth.z();
    p = point_in_earlier_camera(z * ray, velocity, color_s);
  }
  return p;
}

}  // namespace

bool needs_deskewing(const Features& features, const Sensor& sensor) {
  return features.depth_stamp_difference_s != 0 || !sensor.corrections.isZero(0);
}

Features deskew_features(const Features& features, const Sensor& sensor, const Velocity& velocity) {
  Features deskewed = features;
  const Velocity turning{Eigen::Vector3d::Zero(), velocity.angular_rad_s};
  for (size_t i = 0; i < features.size(); ++i) {
    const KeypointMeasurement m = raw_measurement(features, i, sensor.camera.height);
    const bool has_depth = m.depth_m > 0;
    const Eigen::Vector3d p = has_depth
                                  ? deskew_point(m, sensor, velocity)
                                  : point_in_earlier_camera(corrected_ray(sensor, m.pixel).homogeneous(),
                                                            turning, color_time_s(sensor, m.row));
    if (!(p.z() > 0)) continue;
    deskewed.pixels[i] = sensor.camera.project(p).cast<float>();
    deskewed.depths_m[i] = has_depth ? static_cast<float>(p.z()) : 0.0F;
  }
  return deskewed;
}

}  // namespace kinloop
