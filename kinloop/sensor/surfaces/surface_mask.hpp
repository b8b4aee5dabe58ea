#pragma once
// Marks on the points of surface grids: 8UC1 of the grid's size, not 0 = marked. What they mean, such as
// fixed to the camera or moved, is up to the user.

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/sensor/surfaces/surface_grid.hpp"

namespace kinloop {

/// Returns the surfaces without the marked points.
SurfaceGrid without_points(SurfaceGrid surfaces, const cv::Mat& marked);

/// Returns the share of the points that are marked, 0 to 1; 0 if `marked` is empty.
double marked_share(const cv::Mat& marked);

/// Returns the points that are marked in `a` or in `b`; either may be empty.
cv::Mat marked_in_either(const cv::Mat& a, const cv::Mat& b);

/// Returns column and row of the point nearest to an undistorted pixel, which may lie beyond the grid.
Eigen::Vector2f nearest_point(const SurfaceCamera& camera, const Eigen::Vector2f& pixel);

/// Returns whether an undistorted pixel lies at a marked point; `marked` may be empty.
bool is_marked(const cv::Mat& marked, const SurfaceCamera& camera, const Eigen::Vector2f& pixel);

/// Returns a mask for a Frame, 8UC1 of `size`: 0 at the raw pixels that are nearer to a marked point than 1.5
/// times the spacing of the grid, else 255.
cv::Mat unmarked_pixels(const SurfaceCamera& camera, const cv::Mat& marked, const cv::Size& size);

/// Returns the marked points that lie in regions of at least `min_points` and nowhere narrower than three
/// points.
cv::Mat large_regions(const cv::Mat& marked, int min_points);

}  // namespace kinloop
