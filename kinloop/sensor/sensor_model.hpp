#pragma once
// Sensor model: deviations of a Kinect-like camera from an ideal one, namely a rolling shutter, a delay of
// the depth image, and small errors of the lens and depth calibration. All values are corrections: zero is
// the ideal camera.

#include <array>
#include <limits>

#include <Eigen/Core>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/velocity.hpp"

namespace kinloop {

/// Sensor corrections that bundle adjustment can estimate, as indices into a SensorVector. The bias of
/// inverse depth is a second-order polynomial over the image in ray coordinates (x / z, y / z).
enum SensorParameter : int {
  kFocalX,            ///< added to fx, px
  kFocalY,            ///< added to fy, px
  kCenterX,           ///< added to cx, px
  kCenterY,           ///< added to cy, px
  kRadial1,           ///< added radial distortion, r^2
  kRadial2,           ///< added radial distortion, r^4
  kRollingShutter,    ///< readout time from the first to the last colour row, s
  kDepthDelay,        ///< time of the depth measurement minus its stamp, s
  kDepthShutter,      ///< readout time from the first to the last depth row, s
  kDepthScale,        ///< true inverse depth = (1 + scale) * measured + bias
  kInverseDepthBias,  ///< 1/m
  kInverseDepthBiasX,
  kInverseDepthBiasY,
  kInverseDepthBiasXX,
  kInverseDepthBiasXY,
  kInverseDepthBiasYY,
  kSensorParameterCount
};

using SensorVector = Eigen::Matrix<double, kSensorParameterCount, 1>;
using SensorFlags = std::array<bool, kSensorParameterCount>;
using SensorMatrix = Eigen::Matrix<double, kSensorParameterCount, kSensorParameterCount>;

/// Returns the name of a parameter for reports.
const char* sensor_parameter_name(SensorParameter parameter);

/// Values of the corrections with their priors.
struct SensorCalibration {
  static constexpr double kUnknown = std::numeric_limits<double>::infinity();

  SensorVector value = SensorVector::Zero();       ///< initial value, or the value of a constant parameter
  SensorVector prior_mean = SensorVector::Zero();  ///< prior value
  /// Standard deviation around `prior_mean`: 0 = constant at `value`, kUnknown = free without prior.
  SensorVector prior_sigma = SensorVector::Zero();

  // A free parameter is held at its prior mean after the first round if the data constrain it too little or
  // do not change it. The defaults accept every parameter.
  double max_sigma_ratio = kUnknown;  ///< maximum posterior sigma of an accepted parameter / prior sigma
  double min_sigmas = 0;              ///< minimum distance from the prior mean, in posterior sigmas

  /// Returns whether some free parameter may be held after the first round.
  [[nodiscard]] bool selects_parameters() const;
  /// Returns whether a free parameter with this value and posterior sigma is accepted.
  [[nodiscard]] bool accepts(int parameter, double estimated, double posterior_sigma) const;
};

/// Projects the ray (x / z, y / z) with the corrected camera to undistorted pixels of `camera`.
Eigen::Vector2d corrected_pixel(const PinholeCamera& camera, const SensorVector& sensor,
                                const Eigen::Vector2d& ray);

/// Returns the ray of an undistorted pixel in the corrected camera, the inverse of corrected_pixel.
Eigen::Vector2d corrected_ray(const PinholeCamera& camera, const SensorVector& sensor,
                              const Eigen::Vector2d& pixel);

/// Returns the monomials of the inverse depth bias at an undistorted pixel, in order of the parameters from
/// kInverseDepthBias.
Eigen::Matrix<double, 6, 1> inverse_depth_bias_basis(const PinholeCamera& camera,
                                                     const Eigen::Vector2d& pixel);

/// Returns `camera` with the corrected focal length, principal point and distortion, by a fit over the image.
/// The fit error is below 0.1 px for small corrections.
PinholeCamera corrected_camera(const PinholeCamera& camera, const SensorVector& correction);

}  // namespace kinloop
