#pragma once
// Which derivatives of an observation are computed, and where they are stored.

#include <array>
#include <cstddef>
#include <optional>

#include "kinloop/sensor/sensor_model.hpp"

namespace kinloop {

/// Columns of a linearised block of observations: derivatives with respect to x of the pose T * exp(x), the
/// residual and, where wanted, derivatives with respect to velocity, sensor parameters (those that only depth
/// depends on last) and point. Each column holds one value of every observation of the block.
struct LinearColumns {
  static constexpr size_t kResidual = 6;
  static constexpr size_t kMaxWidth = kResidual + 1 + 6 + kSensorParameterCount + 3;

  std::optional<size_t> velocity;                              ///< first of six
  std::array<int, kSensorParameterCount> of_sensor{};          ///< -1 = not wanted
  std::array<int, kSensorParameterCount> sensor_parameters{};  ///< in order of their columns
  size_t sensor_count = 0;
  size_t pixel_end = 0;         ///< end of the columns that pixels depend on, except the point
  size_t used = 0;              ///< number of columns, except the point
  std::optional<size_t> point;  ///< first of three
  size_t width = 0;             ///< all columns, with room for a point

  static LinearColumns of_pose();
  static LinearColumns of_pose_and_velocity();
  /// Pose, point and the sensor parameters that have a prior sigma above zero.
  static LinearColumns of_bundle(const SensorVector& prior_sigma);
  static LinearColumns of_all();

 private:
  LinearColumns(bool with_velocity, const SensorVector& prior_sigma, bool with_point);
};

}  // namespace kinloop
