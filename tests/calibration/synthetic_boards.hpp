#pragma once
// Boards with known poses in front of known cameras.

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "kinloop/core/random.hpp"
#include "tools/calibration/board/board.hpp"
#include "tools/calibration/lens.hpp"

namespace kinloop::test {

inline Board small_board() {
  return parse_board("5x7", 0.03);
}

inline PinholeCamera color_camera() {
  PinholeCamera c;
  c.width = 1920, c.height = 1080;
  c.fx = 1064, c.fy = 1067, c.cx = 983, c.cy = 530;
  c.lens.k1 = 0.03, c.lens.k2 = 0.02, c.lens.p1 = 0.0005, c.lens.p2 = -0.002, c.lens.k3 = -0.05;
  return c;
}

inline PinholeCamera infrared_camera() {
  PinholeCamera c;
  c.width = 512, c.height = 424;
  c.fx = 366, c.fy = 365, c.cx = 253, c.cy = 201;
  c.lens.k1 = 0.09, c.lens.k2 = -0.26, c.lens.p1 = -0.001, c.lens.p2 = 0.0005, c.lens.k3 = 0.09;
  return c;
}

/// The board with its centre at `middle`, rotated by `tilt` (a rotation vector) from facing the camera.
inline SE3 board_at(const Eigen::Vector3d& middle, const Eigen::Vector3d& tilt, const Board& board) {
  const Eigen::Quaterniond rotation = exp_so3(tilt);
  const Eigen::Vector3d own_middle((board.columns - 1) * board.square_m / 2,
                                   (board.rows - 1) * board.square_m / 2, 0);
  return {rotation, middle - rotation * own_middle};
}

/// A pose in view of the camera, tilted by up to `max_tilt_deg` in any direction.
inline SE3 random_pose(Random& random, const Board& board, double max_tilt_deg = 45) {
  const double side = random.uniform(0, 2 * std::numbers::pi);
  const double tilt = random.uniform(0, max_tilt_deg) * std::numbers::pi / 180;
  const Eigen::Vector3d vector(tilt * std::cos(side), tilt * std::sin(side), random.uniform(-0.3, 0.3));
  const double z = random.uniform(0.4, 0.8);
  const double x = random.uniform(-0.35, 0.35) * z, y = random.uniform(-0.2, 0.2) * z;
  return board_at({x, y, z}, vector, board);
}

inline BoardView view_of(const PinholeCamera& camera, const SE3& T_camera_board, const Board& board,
                         const std::string& name) {
  BoardView view{name, camera.width, camera.height, board.corners_m(), {}};
  for (const auto& p : view.board_m) {
    view.pixels.push_back(camera.distort(camera.project(T_camera_board * Eigen::Vector3d(p.x(), p.y(), 0))));
  }
  return view;
}

inline void add_noise(BoardView& view, double sigma_px, Random& random) {
  for (auto& pixel : view.pixels) {
    const double dx = random.gaussian(), dy = random.gaussian();
    pixel += sigma_px * Eigen::Vector2d(dx, dy);
  }
}

inline std::vector<BoardView> random_views(const PinholeCamera& camera, int count, double sigma_px,
                                           uint64_t seed, double max_tilt_deg = 45) {
  Random random(seed);
  std::vector<BoardView> views;
  for (int i = 0; i < count; ++i) {
    const SE3 pose = random_pose(random, small_board(), max_tilt_deg);
    views.push_back(view_of(camera, pose, small_board(), fmt::format("view{}", i)));
    add_noise(views.back(), sigma_px, random);
  }
  return views;
}

/// fx fy cx cy k1 k2 p1 p2 k3.
constexpr int kBrownConradyParameters = 9;

/// Squared deviation of the estimate from the truth in units of its covariance, over the first `count`
/// parameters; about `count` on average if the covariance is right.
inline double squared_deviations(const LensCalibration& c, const PinholeCamera& truth,
                                 int count = kBrownConradyParameters) {
  const Eigen::VectorXd error = (lens_parameters(c.camera) - lens_parameters(truth)).head(count);
  return error.dot(c.covariance.topLeftCorner(count, count).ldlt().solve(error));
}

}  // namespace kinloop::test
