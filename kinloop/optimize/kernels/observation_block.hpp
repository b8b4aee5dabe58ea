#pragma once
// SIMD evaluation of the residuals and derivatives of eight observations of one moving rolling-shutter
// camera. Bitwise identical on every instruction set.

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "kinloop/geometry/se3.hpp"
#include "kinloop/geometry/velocity.hpp"
#include "kinloop/optimize/kernels/linear_columns.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Pose and velocity of a camera in the form used to evaluate its observations.
struct BundleView {
  Eigen::Matrix3d R_camera_world;
  Eigen::Vector3d center;  ///< in the world frame
  Velocity velocity;

  BundleView(const SE3& T_world_camera, const Velocity& v)
      : R_camera_world(T_world_camera.R().transpose()), center(T_world_camera.translation), velocity(v) {}
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
  Lanes depth_stamp_difference_s{};  ///< KeypointMeasurement::depth_stamp_difference_s
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
BlockResiduals block_residuals(const ObservationBlock& block, const BundleView& view, const Sensor& sensor);

/// Returns the robust cost of each observation, over its parts in use.
ObservationBlock::Lanes block_cost(const ObservationBlock& block, const BundleView& view,
                                   const Sensor& sensor);

constexpr size_t kRowsPerObservation = 3;  ///< u, v, depth

/// Writes the columns of the rows u, v and depth, one row after the other, scaled by the square root of the
/// robust weight and zero where not in use. `columns` must be zero-initialised. Returns the robust cost like
/// block_cost.
ObservationBlock::Lanes linearize_block(const ObservationBlock& block, const BundleView& view,
                                        const Sensor& sensor, const LinearColumns& layout, double* columns);

}  // namespace kinloop
