#pragma once
// Whether two depth images can be of one scene under a relative pose. Walls count as much as texture: each
// image is reduced to a coarse grid of its surfaces, and each grid is compared with the other.
//
// A point that lies in front of the surface which the other view measures in its direction contradicts the
// pose, since that view saw through it. A point behind it is occluded, which says nothing.

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Data of a camera shared by the grids of all its frames. The grid is that of an ideal pinhole camera.
struct SurfaceCamera {
  PinholeCamera grid;                 ///< scaled to the grid, without distortion
  std::vector<Eigen::Vector2f> rays;  ///< (x / z, y / z) of each grid point
  std::vector<cv::Point> pixels;  ///< (distorted) depth pixel of each grid point; x = -1 outside the image
  int spacing_px = 1;             ///< between neighbouring grid points
  DepthNoise noise;               ///< of depth on surfaces
};

/// Returns the grid for the camera of `sensor`: at most 64 points wide.
std::shared_ptr<const SurfaceCamera> make_surface_camera(const Sensor& sensor);

/// The surfaces that a frame shows, row by row. Inverse depth is linear on a plane.
struct SurfaceGrid {
  std::shared_ptr<const SurfaceCamera> camera;
  std::vector<float> inverse_depths_per_m;  ///< 0 = unknown
  std::vector<Eigen::Vector2f> gradients;   ///< of inverse depth, 1/m per grid step; NaN at edges
};

/// Samples a depth image, 32FC1 of the camera's size in metres with 0 (or NaN) = unknown.
SurfaceGrid make_surface_grid(std::shared_ptr<const SurfaceCamera> camera, const cv::Mat& depth_m);

/// Returns whether depth is known at more than a few points.
bool has_depth(const SurfaceGrid& surfaces);

/// How a point lies to the surface that another view measures in its direction.
enum class PointState : uint8_t {
  kUnknown,       ///< one of the two is not known, or the point is out of view
  kConsistent,    ///< on the surface
  kContradicted,  ///< in front of it, where the other view saw through
  kOccluded,      ///< behind it
};

/// Returns the state of a point in `view`, given in the axes of its camera, m. Within the noise of depth and
/// 1 cm (1 sigma) for the position.
PointState state_in_view(const Eigen::Vector3d& p_view, const SurfaceGrid& view);

/// Returns the state of each grid point of `points` in `view`, within the noise of depth and 1 cm (1 sigma)
/// for the relative position.
std::vector<PointState> states_in_view(const SurfaceGrid& points, const SurfaceGrid& view,
                                       const SE3& T_view_points);

/// Returns ln(depth measured by `view` / depth expected of a point of `points`) for each point that both
/// show.
std::vector<float> log_depth_ratios(const SurfaceGrid& points, const SurfaceGrid& view,
                                    const SE3& T_view_points);

/// Numbers of grid points of two views by their state in the other one.
struct SurfaceAgreement {
  int consistent = 0;
  int contradicted = 0;
  int occluded = 0;

  static constexpr int kMinPoints = 200;  ///< in both views; fewer decide nothing

  SurfaceAgreement& operator+=(const SurfaceAgreement& other);

  /// Whether enough points are visible to decide on the pose.
  [[nodiscard]] bool decides() const { return consistent + contradicted >= kMinPoints; }

  /// Share of the visible points that contradict the pose; 0 if there are none.
  [[nodiscard]] double contradicted_share() const;
};

/// Compares two grids of one camera, each with the other.
SurfaceAgreement compare_surfaces(const SurfaceGrid& a, const SurfaceGrid& b, const SE3& T_a_b);

}  // namespace kinloop
