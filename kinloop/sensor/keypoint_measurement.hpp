#pragma once
// What a camera measured of one keypoint: the input of every estimator. It is defined here, below
// `features`, because the solvers of `optimize` do not know features.

#include <Eigen/Core>

namespace kinloop {

/// Pixel and depth of one keypoint, with what their errors and their times depend on.
struct KeypointMeasurement {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< undistorted
  double depth_m = 0;                               ///< measured z, 0 = unknown
  double sigma_px = 1;                              ///< standard deviation of `pixel`
  double row = 0;  ///< its raw image row as a share of the height, -0.5 (first) to 0.5 (last)
  double depth_stamp_difference_s = 0;  ///< stamp of its depth image minus stamp of its colour image
  /// How the inverse depth changes over the undistorted image around `pixel`, 1/m per px: depth is measured a
  /// little later than colour, when another spot of the surface lies under that pixel. NaN where unknown:
  /// depth is then taken to be of the time of its row.
  Eigen::Vector2d inverse_depth_gradient = Eigen::Vector2d::Zero();
};

}  // namespace kinloop
