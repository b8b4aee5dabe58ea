#pragma once
// Parameters of the sensor model: deviations of a Kinect-like camera from an ideal one, namely a rolling
// shutter, a delay of the depth image, and small errors of the lens and depth calibration. All values are
// corrections: zero is the ideal camera.

#include <array>
#include <limits>
#include <vector>

#include <Eigen/Core>

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

/// Returns the name of a parameter in run.json and reports.
const char* sensor_parameter_name(SensorParameter parameter);

/// What is known of the corrections before they are estimated.
struct SensorPrior {
  static constexpr double kUnknown = std::numeric_limits<double>::infinity();

  SensorVector mean = SensorVector::Zero();
  /// Standard deviation around `mean`: 0 = the parameter is constant, kUnknown = free without prior.
  SensorVector sigma = SensorVector::Zero();

  // A free parameter is held at its prior mean after the first round if the data constrain it too little or
  // do not change it. The defaults accept every parameter.
  double max_sigma_ratio = kUnknown;  ///< maximum posterior sigma of an accepted parameter / prior sigma
  double min_sigmas = 0;              ///< minimum distance from the prior mean, in posterior sigmas
  /// Parameters whose mean is that of a kind of sensor, not a calibration: min_sigmas does not protect it.
  SensorFlags typical{};

  /// Returns whether some free parameter may be held after the first round.
  [[nodiscard]] bool selects_parameters() const;
  /// Returns whether a free parameter with this value and posterior sigma is accepted.
  [[nodiscard]] bool accepts(int parameter, double estimated, double posterior_sigma) const;
  /// Returns the indices of the free parameters.
  [[nodiscard]] std::vector<int> free_parameters() const;
  /// Returns the inverse variance of a free parameter; 0 without prior.
  [[nodiscard]] double information(int parameter) const;
};

}  // namespace kinloop
