#pragma once
// Pose, velocity and camera of an image: what is needed besides its pixels to place its surfaces in the
// world.

#include <cstddef>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/velocity.hpp"
#include "kinloop/sensor/depth_noise.hpp"

namespace kinloop {

/// Intensities from here on may be saturated.
constexpr int kSaturatedIntensity = 250;

/// A stored image and its pose.
struct PosedImage {
  size_t image = 0;  ///< index into the ImageStore
  SE3 T_world_camera;
  Velocity velocity = {};               ///< in camera axes
  double depth_stamp_difference_s = 0;  ///< stamp of its depth image minus stamp of its colour image
  /// Gains for red, green and blue that compensate exposure and white balance, see color_gains.
  Eigen::Vector3f color_gain = Eigen::Vector3f::Ones();
};

/// What the lens does not tell: rolling shutters, a delay of depth relative to the colour image, and a smooth
/// deformation of depth.
struct DenseCamera {
  PinholeCamera color;       ///< of the raw colour image, to which depth is registered
  double depth_delay_s = 0;  ///< time of the middle depth row after the stamp of depth
  double readout_s = 0;      ///< readout time from the first to the last depth row
  /// Added to inverse depth, 1/m: coefficients of 1, x, y, xx, xy, yy of the ray (x / z, y / z).
  Vector6d inverse_depth_correction = Vector6d::Zero();
  DepthNoise noise = {};       ///< on planes
  double color_readout_s = 0;  ///< readout time of the colour image; its stamp is that of the middle row

  /// Returns when a depth row was measured, relative to the stamp of depth.
  [[nodiscard]] double time_of_row_s(double row) const {
    return depth_delay_s + readout_s * (row / color.height - 0.5);
  }

  /// Returns the position, at the stamp of colour, of a point measured at `p` in `row` of a depth image that
  /// is `lag_s` younger. First order: turning by 1 rad/s for 30 ms leaves an error of 0.5 mm at 1 m.
  [[nodiscard]] Eigen::Vector3d deskew(const Eigen::Vector3d& p, double row, const Velocity& velocity,
                                       double lag_s) const {
    return p + (lag_s + time_of_row_s(row)) * (velocity.linear_m_s + velocity.angular_rad_s.cross(p));
  }

  /// Inverse of `deskew`: returns where a point at `p` at the stamp, in front of the camera, was measured.
  [[nodiscard]] Eigen::Vector3d undo_deskew(const Eigen::Vector3d& p, const Velocity& velocity,
                                            double lag_s) const {
    return p - (lag_s + time_of_row_s(color.project(p).y())) *
                   (velocity.linear_m_s + velocity.angular_rad_s.cross(p));
  }

  /// Returns the raw pixel at which the moving camera sees a point `p` given in its axes at the stamp of
  /// colour, z > 0. First order, as above.
  [[nodiscard]] Eigen::Vector2d raw_color_pixel(const Eigen::Vector3d& p, const Velocity& velocity) const {
    const auto raw_pixel = [&](const Eigen::Vector3d& seen) {
      const Eigen::Vector2d ideal = color.project(seen);
      return color.has_distortion() ? color.distort(ideal) : ideal;
    };
    Eigen::Vector2d raw = raw_pixel(p);
    if (color_readout_s == 0) return raw;
    constexpr int kRounds = 2;  // the row changes by far less than the image during its readout
    const Eigen::Vector3d change_m_s = velocity.linear_m_s + velocity.angular_rad_s.cross(p);
    for (int round = 0; round < kRounds; ++round) {
      const double time_s = color_readout_s * (raw.y() / color.height - 0.5);
      raw = raw_pixel(p - time_s * change_m_s);
    }
    return raw;
  }

  /// Returns measured inverse depth, 1/m, corrected for the deformation.
  [[nodiscard]] double correct_inverse_depth(double inverse_depth, double ray_x, double ray_y) const {
    const Vector6d& c = inverse_depth_correction;
    return inverse_depth + c(0) + c(1) * ray_x + c(2) * ray_y + c(3) * ray_x * ray_x + c(4) * ray_x * ray_y +
           c(5) * ray_y * ray_y;
  }
};

}  // namespace kinloop
