#pragma once
// How a Kinect-like camera departs from an ideal one: rows exposed one after the other, depth taken at
// another time, lens and depth a little off their calibration. All values are corrections: zero is the ideal
// camera.

#include <array>
#include <limits>

#include <Eigen/Core>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/velocity.hpp"

namespace kinloop {

/// The corrections that adjustment can estimate; indices into a SensorVector. The depth offset is a
/// polynomial of the second order over the image, in ray coordinates (x / z, y / z).
enum SensorParameter : int {
  kFocalX,          ///< added to fx, px
  kFocalY,          ///< added to fy, px
  kCenterX,         ///< added to cx, px
  kCenterY,         ///< added to cy, px
  kRadial1,         ///< added radial distortion, r^2
  kRadial2,         ///< added radial distortion, r^4
  kRollingShutter,  ///< time from the first colour row to the last, s
  kDepthDelay,      ///< time of the depth measurement minus time of its colour image, s
  kDepthShutter,    ///< time from the first depth row to the last, s
  kDepthScale,      ///< true inverse depth = (1 + scale) * measured + offset
  kDepthOffset,     ///< 1/m
  kDepthOffsetX,
  kDepthOffsetY,
  kDepthOffsetXX,
  kDepthOffsetXY,
  kDepthOffsetYY,
  kSensorParameterCount
};

using SensorVector = Eigen::Matrix<double, kSensorParameterCount, 1>;
using SensorMatrix = Eigen::Matrix<double, kSensorParameterCount, kSensorParameterCount>;

/// The name of a parameter, as reports print it.
const char* sensor_parameter_name(SensorParameter parameter);

/// Values of the corrections and how freely each may move.
struct SensorCalibration {
  static constexpr double kUnknown = std::numeric_limits<double>::infinity();

  SensorVector value = SensorVector::Zero();       ///< where adjustment starts, or what is held
  SensorVector prior_mean = SensorVector::Zero();  ///< what was known beforehand
  /// Standard deviation around `prior_mean`: 0 = held at `value`, kUnknown = free without a prior.
  SensorVector prior_sigma = SensorVector::Zero();
};

/// Where the corrected camera sees the ray (x / z, y / z), in undistorted pixels of `camera`.
Eigen::Vector2d corrected_pixel(const PinholeCamera& camera, const SensorVector& sensor,
                                const Eigen::Vector2d& ray);

/// The inverse of corrected_pixel: the ray that the corrected camera sees at an undistorted pixel.
Eigen::Vector2d corrected_ray(const PinholeCamera& camera, const SensorVector& sensor,
                              const Eigen::Vector2d& pixel);

/// The depth offset's polynomial at an undistorted pixel, in the order of kDepthOffset and those behind it.
Eigen::Matrix<double, 6, 1> depth_offset_basis(const PinholeCamera& camera, const Eigen::Vector2d& pixel);

/// `camera` with the corrections of focal length, centre and distortion worked in (a fit over the image; the
/// remaining difference is below a tenth of a pixel for the small corrections meant here).
PinholeCamera corrected_camera(const PinholeCamera& camera, const SensorVector& correction);

}  // namespace kinloop
