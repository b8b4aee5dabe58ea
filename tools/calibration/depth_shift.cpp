#include "tools/calibration/depth_shift.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"

namespace kinloop {
namespace {

/// Standard deviations per median absolute deviation of normal errors.
constexpr double kPerMad = 1.4826;

double robust_deviation(const std::vector<double>& values, double center) {
  std::vector<double> distances;
  for (const double v : values) distances.push_back(std::abs(v - center));
  return kPerMad * median(std::move(distances));
}

/// Least squares line through the boards' shifts over their distance.
void fit_slope(DepthShift& shift) {
  const auto count = static_cast<double>(shift.boards.size());
  constexpr double kMinCount = 3;
  if (count < kMinCount) return;
  double mean_z = 0, mean_shift = 0, zz = 0, zs = 0;
  for (const auto& b : shift.boards) mean_z += b.distance_m / count, mean_shift += b.shift_m / count;
  for (const auto& b : shift.boards) {
    zz += std::pow(b.distance_m - mean_z, 2);
    zs += (b.distance_m - mean_z) * (b.shift_m - mean_shift);
  }
  if (!(zz > 0)) return;
  shift.slope = zs / zz;
  double rest = 0;
  for (const auto& b : shift.boards) {
    rest += std::pow(b.shift_m - mean_shift - shift.slope * (b.distance_m - mean_z), 2);
  }
  shift.slope_sigma = std::sqrt(rest / (count - 2) / zz);
}

}  // namespace

std::optional<DepthResidual> plane_residual(const BoardDepthView& in_depth, const PinholeCamera& camera,
                                            const Board& board) {
  constexpr size_t kMinPixels = 100;
  const SE3 T_board_depth = in_depth.T_depth_board.inverse();
  const Eigen::Vector3d normal = in_depth.T_depth_board.R().col(2);
  const double offset = normal.dot(in_depth.T_depth_board.translation);
  std::vector<double> distances, differences;
  for (int y = 0; y < in_depth.depth_m.rows; ++y) {
    for (int x = 0; x < in_depth.depth_m.cols; ++x) {
      const auto measured_m = static_cast<double>(in_depth.depth_m.at<float>(y, x));
      if (!(measured_m > 0)) continue;
      const Eigen::Vector3d ray = camera.unproject(camera.undistort(Eigen::Vector2d(x, y)), 1);
      const double plane_m = offset / normal.dot(ray);  // where n . (z ray) = n . t
      const Eigen::Vector3d on_board = T_board_depth * Eigen::Vector3d(plane_m * ray);
      const bool inside = on_board.x() >= 0 && on_board.x() <= (board.columns - 1) * board.square_m &&
                          on_board.y() >= 0 && on_board.y() <= (board.rows - 1) * board.square_m;
      if (!inside || plane_m <= 0) continue;
      distances.push_back(plane_m);
      differences.push_back(plane_m - measured_m);
    }
  }
  if (distances.size() < kMinPixels) return std::nullopt;
  DepthResidual residual{in_depth.name, median(distances), median(differences), 0, distances.size()};
  residual.spread_m = robust_deviation(differences, residual.shift_m);
  return residual;
}

DepthShift estimate_depth_shift(const std::vector<BoardDepthView>& boards, const PinholeCamera& camera,
                                const Board& board, double relative_focal_sigma) {
  DepthShift shift;
  std::vector<double> shifts, distances;
  for (const BoardDepthView& in_depth : boards) {
    const auto residual = plane_residual(in_depth, camera, board);
    if (!residual) continue;
    shift.boards.push_back(*residual);
    shifts.push_back(residual->shift_m);
    distances.push_back(residual->distance_m);
  }
  if (shifts.empty()) {
    throw InputError(
        "no board has depth: the depth images must show the board, with 0 where depth is unknown");
  }
  shift.shift_m = median(shifts);
  const auto count = static_cast<double>(shifts.size());
  // A median of normal errors has pi/2 times the variance of their mean.
  const double from_boards_m =
      std::sqrt(std::acos(-1.0) / 2 / count) * robust_deviation(shifts, shift.shift_m);
  shift.sigma_m = std::hypot(from_boards_m, median(distances) * relative_focal_sigma);
  fit_slope(shift);
  return shift;
}

}  // namespace kinloop
