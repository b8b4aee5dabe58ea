#pragma once
// SIMD evaluation of the residuals and derivatives of eight observations of one moving rolling-shutter
// camera. Bitwise identical on every instruction set.

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "kinloop/optimize/bundle/sensor_model.hpp"

namespace kinloop {

/// Pose and velocity of a camera in the form used to evaluate its observations.
struct BundleView {
  Eigen::Matrix3d R_camera_world;
  Eigen::Vector3d center;  ///< in the world frame
  Velocity velocity;

  BundleView(const SE3& T_world_camera, const Velocity& v)
      : R_camera_world(T_world_camera.R().transpose()), center(T_world_camera.translation), velocity(v) {}
};

/// Camera, sensor corrections and noise model of a measurement.
struct MeasurementModel {
  const PinholeCamera& camera;
  const SensorVector& sensor;
  double inverse_depth_sigma_per_m = 0;
  double robust_width = 0;  ///< scale of the Huber loss
};

/// Observations in structure-of-arrays layout. Empty lanes are not in use.
struct ObservationBlock {
  static constexpr size_t kSize = 8;
  using Lanes = std::array<double, kSize>;

  Lanes x{}, y{}, z{};               ///< the point in the world frame, m
  Lanes pixel_x{}, pixel_y{};        ///< undistorted
  Lanes inverse_sigma_px{};          ///< 1 / standard deviation of the pixel
  Lanes row{};                       ///< KeypointMeasurement::row
  Lanes inverse_depth_per_m{};       ///< measured, 0 = unknown
  Lanes gradient_x{}, gradient_y{};  ///< KeypointMeasurement::inverse_depth_gradient, 0 if unknown
  Lanes has_gradient{};              ///< 1 = known
  Lanes uses_pixel{}, uses_depth{};  ///< 1 = in use; depth is used only with its pixel
};

/// Residuals in standard deviations. The depth residual is 0 if depth was not measured.
struct BlockResiduals {
  ObservationBlock::Lanes u, v, depth;
  ObservationBlock::Lanes seen;  ///< 0 if the point is behind the camera

  /// Returns whether the squared pixel residual is at most `max_squared`.
  [[nodiscard]] bool is_pixel_inlier(size_t lane, double max_squared) const {
    return seen[lane] > 0 && u[lane] * u[lane] + v[lane] * v[lane] <= max_squared;
  }
  /// Returns whether depth was measured and its squared residual is at most `max_squared`.
  [[nodiscard]] bool is_depth_inlier(size_t lane, double max_squared) const {
    return depth[lane] * depth[lane] <= max_squared;
  }
};

constexpr double kMinObservedDepth_m = 1e-3;  ///< closer points and points behind the camera are not visible

/// Squared residual assigned to a point behind the camera.
constexpr double kBehindCameraSquared = 1e6;

/// Returns the residuals of all measurements, in use or not.
BlockResiduals block_residuals(const ObservationBlock& block, const BundleView& view,
                               const MeasurementModel& model);

/// Returns the robust cost of each observation, over its parts in use.
ObservationBlock::Lanes block_cost(const ObservationBlock& block, const BundleView& view,
                                   const MeasurementModel& model);

/// Layout of a row of `width` values: derivatives with respect to x of the pose T * exp(x), then optionally
/// velocity and sensor, then the residual, then padding.
struct RowLayout {
  RowLayout(bool with_velocity, bool with_sensor);

  std::optional<size_t> velocity, sensor;  ///< first column
  size_t residual;
  size_t width;  ///< multiple of kWidthStep, see gram.hpp
};

constexpr size_t kRowsPerObservation = 3;  ///< u, v, depth

/// Writes the three rows of each observation in sequence, and to `J_point`, unless null, their derivatives
/// with respect to the point (3 x 3, row-major). All are scaled by the square root of the robust weight and
/// zero if not in use. `rows` must be zero-initialised. Returns the robust cost like block_cost.
ObservationBlock::Lanes linearize_block(const ObservationBlock& block, const BundleView& view,
                                        const MeasurementModel& model, const RowLayout& layout, double* rows,
                                        double* J_point);

/// Same values without J_point, in another order: the rows u, v and depth, in each of them one column after
/// the other, which holds one value of every observation.
ObservationBlock::Lanes linearize_in_columns(const ObservationBlock& block, const BundleView& view,
                                             const MeasurementModel& model, const RowLayout& layout,
                                             double* columns);

/// Columns of a linearised block: derivatives with respect to x of the pose T * exp(x), the residual,
/// derivatives with respect to the free sensor parameters, those that only depth depends on last, and to the
/// point. Each column holds one value of every observation of the block.
struct BundleColumns {
  static constexpr size_t kResidual = 6, kSensor = 7;
  static constexpr size_t kMaxWidth = kSensor + kSensorParameterCount + 3;

  std::array<int, kSensorParameterCount> of_sensor{};          ///< column, -1 = not free
  std::array<int, kSensorParameterCount> sensor_parameters{};  ///< in order of their columns
  size_t sensor_count = 0;
  size_t pixel_end = kSensor;  ///< end of the columns that pixels depend on, before the point

  /// Parameters with a prior sigma above zero are free.
  explicit BundleColumns(const SensorVector& prior_sigma);

  [[nodiscard]] size_t point() const { return kSensor + sensor_count; }
  [[nodiscard]] size_t width() const { return point() + 3; }
};

/// Writes the columns of the rows u, v and depth, one row after the other, scaled by the square root of the
/// robust weight and zero where not in use. `columns` must be zero-initialised.
void linearize_block(const ObservationBlock& block, const BundleView& view, const MeasurementModel& model,
                     const BundleColumns& layout, double* columns);

}  // namespace kinloop
