#pragma once
// In: eight observations of one moving, rolling camera, side by side. Out: their residuals and the
// derivatives of these, all eight by the same instructions. The same bits on every instruction set.

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "kinloop/optimize/bundle/sensor_model.hpp"

namespace kinloop {

/// The pose and velocity of a camera in the form that its many observations need.
struct BundleView {
  Eigen::Matrix3d R_camera_world;
  Eigen::Vector3d center;  ///< in the world
  Velocity velocity;

  BundleView(const SE3& T_world_camera, const Velocity& v)
      : R_camera_world(T_world_camera.R().transpose()), center(T_world_camera.translation), velocity(v) {}
};

/// What predicts a measurement, and by what its error is measured.
struct MeasurementModel {
  const PinholeCamera& camera;
  const SensorVector& sensor;
  double inverse_depth_sigma_per_m = 0;
  double robust_width = 0;  ///< of Huber's loss
};

/// Observations, each number of all of them side by side. Places that are not filled are not in use.
struct ObservationBlock {
  static constexpr size_t kSize = 8;
  using Lanes = std::array<double, kSize>;

  Lanes x{}, y{}, z{};               ///< the point in the world, m
  Lanes pixel_x{}, pixel_y{};        ///< undistorted
  Lanes inverse_sigma_px{};          ///< 1 / standard deviation of the pixel
  Lanes row{};                       ///< KeypointMeasurement::row
  Lanes inverse_depth_per_m{};       ///< measured, 0 = unknown
  Lanes gradient_x{}, gradient_y{};  ///< KeypointMeasurement::inverse_depth_gradient, 0 where it is unknown,
  Lanes has_gradient{};              ///< 1 = known
  Lanes uses_pixel{}, uses_depth{};  ///< 1 = in use; depth only with its pixel
};

/// Residuals in standard deviations. That of depth is 0 where none was measured.
struct BlockResiduals {
  ObservationBlock::Lanes u, v, depth;
  ObservationBlock::Lanes seen;  ///< 0 where the point is behind the camera

  /// Whether the pixel is seen where it should be, as far as `max_squared` allows.
  [[nodiscard]] bool is_pixel_inlier(size_t lane, double max_squared) const {
    return seen[lane] > 0 && u[lane] * u[lane] + v[lane] * v[lane] <= max_squared;
  }
  /// The same for a depth that was measured.
  [[nodiscard]] bool is_depth_inlier(size_t lane, double max_squared) const {
    return depth[lane] * depth[lane] <= max_squared;
  }
};

constexpr double kMinObservedDepth_m = 1e-3;  ///< nearer to the camera, or behind it, is not seen

/// The squared residual that stands for a point behind the camera.
constexpr double kBehindCameraSquared = 1e6;

/// Residuals of all that was measured, in use or not.
BlockResiduals block_residuals(const ObservationBlock& block, const BundleView& view,
                               const MeasurementModel& model);

/// Robust cost of what is in use, of each observation.
ObservationBlock::Lanes block_cost(const ObservationBlock& block, const BundleView& view,
                                   const MeasurementModel& model);

/// How a residual and its derivatives stand in a row of `width` numbers: those by x of the pose T * exp(x)
/// first, then where asked for those by velocity and by the sensor, then the residual, then nothing.
struct RowLayout {
  RowLayout(bool with_velocity, bool with_sensor);

  std::optional<size_t> velocity, sensor;  ///< their first columns
  size_t residual;
  size_t width;  ///< a multiple of kWidthStep, see gram.hpp
};

constexpr size_t kRowsPerObservation = 3;  ///< u, v, depth

/// Writes the three rows of each observation one below the other, and to `J_point`, unless it is null, their
/// derivatives by the point (3 x 3, row by row); all times the root of the robust weight, zero where not in
/// use. `rows` must be zero where nothing was written before. Gives the robust cost like block_cost.
ObservationBlock::Lanes linearize_block(const ObservationBlock& block, const BundleView& view,
                                        const MeasurementModel& model, const RowLayout& layout, double* rows,
                                        double* J_point);

}  // namespace kinloop
