#pragma once
// In: posed depth images. Out: where on the floor plan rays passed, at which heights.

#include <span>

#include <opencv2/core/mat.hpp>

#include "dense/image_store.hpp"
#include "dense/options.hpp"
#include "dense/posed_image.hpp"
#include "kinloop/core/progress.hpp"

namespace kinloop {

/// A rectangle of the plan, divided into square cells.
struct PlanGrid {
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< corner of cell (0, 0), of the smallest x and y
  double cell_m = 0.025;
  cv::Size size = {};  ///< cells

  /// Returns the cell that contains `p_m`; it may be outside.
  [[nodiscard]] cv::Point cell(const Eigen::Vector2d& p_m) const;

  /// Returns the middle of a cell.
  [[nodiscard]] Eigen::Vector2d middle_m(const cv::Point& cell) const;

  /// Returns whether the cell lies in the grid.
  [[nodiscard]] bool contains(const cv::Point& cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.x < size.width && cell.y < size.height;
  }
};

/// Heights above the floor, metres.
struct HeightRange {
  double low_m = 0, high_m = 0;

  [[nodiscard]] bool contains(double z_m) const { return z_m >= low_m && z_m < high_m; }
};

/// The depth images of a map in the frame of the plan: z up, the floor at 0.
struct PlanViews {
  const ImageStore& images;
  std::span<const PosedImage> views;
  const PinholeCamera& camera;
  SE3 T_plan_world;
  DepthLimits limits;
};

/// Returns for each range of heights an image of the grid, 8UC1: 255 = at least two views, or the only one,
/// saw through some of that range.
std::vector<cv::Mat> observed_free_space(const PlanViews& views, const PlanGrid& grid,
                                         std::span<const HeightRange> ranges, const Progress& progress);

}  // namespace kinloop
