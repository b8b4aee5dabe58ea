#pragma once
// In: the board's pose in the depth camera and the depth image of the same moment. Out: what to add to
// measured depth.

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"
#include "tools/calibration/board.hpp"

namespace kinloop {

/// A board with known pose in front of the depth camera.
struct BoardDepthView {
  std::string name;
  SE3 T_depth_board;
  cv::Mat depth_m;  ///< 32FC1, 0 = unknown
};

/// One board: its plane against what was measured of it.
struct DepthResidual {
  std::string name;
  double distance_m = 0;  ///< median depth of the plane
  double shift_m = 0;     ///< median of plane less measured
  double spread_m = 0;    ///< robust standard deviation of a pixel
  size_t pixels = 0;
};

struct DepthShift {
  double shift_m = 0;  ///< to be added to measured depth: median over the boards
  double sigma_m = 0;  ///< one standard deviation, from how the boards differ and from the focal length's
  double slope = 0;    ///< change of the shift per metre of distance; a wrong focal length shows here
  double slope_sigma = 0;
  std::vector<DepthResidual> boards;
};

/// The plane of one board against measured depth, over all pixels within its corners; nothing where fewer
/// than some hundred have depth.
std::optional<DepthResidual> plane_residual(const BoardDepthView& depth_view, const PinholeCamera& camera,
                                            const Board& board);

/// The shift over all boards. The boards' distances go with the focal length, so that its relative standard
/// deviation is part of the result's. Throws InputError where no board has depth.
DepthShift estimate_depth_shift(const std::vector<BoardDepthView>& boards, const PinholeCamera& camera,
                                const Board& board, double relative_focal_sigma = 0);

}  // namespace kinloop
