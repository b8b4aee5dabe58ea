#pragma once
// Where an image was taken, and by what: all that is needed beside its pixels to put its surfaces into the
// world.

#include <cstddef>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// Intensities from here on may have been brighter than the sensor could tell.
constexpr int kSaturatedIntensity = 250;

/// A stored image and where it was taken.
struct PosedImage {
  size_t image = 0;  ///< index into the ImageStore
  SE3 T_world_camera;
  Vector6d velocity = Vector6d::Zero();  ///< m/s, then rad/s, both in camera axes
  /// Factors for its red, green and blue that even out exposure and white balance, see color_gains.
  Eigen::Vector3f color_gain = Eigen::Vector3f::Ones();
};

/// How depth comes about beside the lens: rows are read out one after the other, some time after the colour
/// image; and a smooth deformation.
struct DenseCamera {
  PinholeCamera color;       ///< of the raw colour image; depth is registered to it
  double depth_delay_s = 0;  ///< of depth's middle row after the stamp
  double readout_s = 0;      ///< from depth's first row to its last
  /// To be added to inverse depth, 1/m: a polynomial 1, x, y, xx, xy, yy of the ray (x / z, y / z).
  Vector6d inverse_depth_correction = Vector6d::Zero();

  /// When a row of depth was measured, after the stamp.
  [[nodiscard]] double time_of_row_s(double row) const {
    return depth_delay_s + readout_s * (row / color.height - 0.5);
  }

  /// Where the camera would have seen, at the stamp, the point that it measured at `p` in `row`. To the first
  /// order: turning by 1 rad/s for 30 ms leaves 0.5 mm at 1 m.
  [[nodiscard]] Eigen::Vector3d deskew(const Eigen::Vector3d& p, double row, const Vector6d& velocity) const {
    return p + time_of_row_s(row) * (velocity.head<3>() + velocity.tail<3>().cross(p));
  }

  /// The inverse: where it measured a point that at the stamp was at `p`, which must be in front of it.
  [[nodiscard]] Eigen::Vector3d undo_deskew(const Eigen::Vector3d& p, const Vector6d& velocity) const {
    return p - time_of_row_s(color.project(p).y()) * (velocity.head<3>() + velocity.tail<3>().cross(p));
  }

  /// What measured depth is, the deformation taken away, 1/m.
  [[nodiscard]] double correct_inverse_depth(double inverse_depth, double ray_x, double ray_y) const {
    const Vector6d& c = inverse_depth_correction;
    return inverse_depth + c(0) + c(1) * ray_x + c(2) * ray_y + c(3) * ray_x * ray_x + c(4) * ray_x * ray_y +
           c(5) * ray_y * ray_y;
  }
};

}  // namespace kinloop
