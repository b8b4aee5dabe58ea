#pragma once
// In: board poses in the depth camera with the depth images. Out: the correction to add to measured depth.

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"
#include "tools/calibration/board/board.hpp"

namespace kinloop {

/// A board with known pose in front of the depth camera.
struct BoardDepthView {
  std::string name;
  SE3 T_depth_board;
  cv::Mat depth_m;  ///< 32FC1, 0 = unknown
};

/// Deviation of measured depth from the plane of one board.
struct DepthResidual {
  std::string name;
  double distance_m = 0;  ///< median depth of the plane
  double shift_m = 0;     ///< median of plane minus measured
  double spread_m = 0;    ///< robust standard deviation of a pixel
  size_t pixels = 0;
};

struct DepthShift {
  double shift_m = 0;  ///< to be added to measured depth: median over the boards
  double sigma_m =
      0;  ///< one standard deviation, from the scatter of the boards and the uncertainty of the focal length
  double slope = 0;  ///< change of the shift per metre of distance; reveals a wrong focal length
  double slope_sigma = 0;
  std::vector<DepthResidual> boards;
};

/// Compares the plane of one board with measured depth over all pixels within its corners; nullopt if fewer
/// than some hundred have depth.
std::optional<DepthResidual> plane_residual(const BoardDepthView& depth_view, const PinholeCamera& camera,
                                            const Board& board);

/// Estimates the shift over all boards. The boards' distances scale with the focal length, so its relative
/// standard deviation enters the result's. Throws InputError if no board has depth.
DepthShift estimate_depth_shift(const std::vector<BoardDepthView>& boards, const PinholeCamera& camera,
                                const Board& board, double relative_focal_sigma = 0);

}  // namespace kinloop
