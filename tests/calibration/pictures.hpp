#pragma once
// Renders boards as seen by a camera with known pose and distortion.

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "tests/calibration/synthetic_boards.hpp"

namespace kinloop::test {

/// Renders a plane: each pixel averages 4 x 4 samples of `grey`, a function of the position on the plane in
/// metres.
template <class Grey>
cv::Mat render_plane(const PinholeCamera& camera, const SE3& T_camera_board, const Grey& grey) {
  constexpr int kSamples = 4;
  const SE3 T_board_camera = T_camera_board.inverse();
  cv::Mat image(camera.height, camera.width, CV_32FC1);
  const auto look = [&](double x, double y) {
    const Eigen::Vector3d ray = T_board_camera.rotation * camera.unproject(camera.undistort({x, y}), 1);
    const Eigen::Vector3d p = T_board_camera.translation - T_board_camera.translation.z() / ray.z() * ray;
    return grey(p.x(), p.y());
  };
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      float sum = 0;
      for (int i = 0; i < kSamples * kSamples; ++i) {
        sum += look(x + (i % kSamples + 0.5) / kSamples - 0.5, y + (i / kSamples + 0.5) / kSamples - 0.5);
      }
      image.at<float>(y, x) = sum / (kSamples * kSamples);
    }
  }
  return image;
}

/// A chessboard: 1 white, 0 black.
inline cv::Mat picture(const PinholeCamera& camera, const SE3& T_camera_board, const Board& board) {
  return render_plane(camera, T_camera_board, [&](double x, double y) {
    const int column = static_cast<int>(std::floor(x / board.square_m)),
              row = static_cast<int>(std::floor(y / board.square_m));
    const bool on_board = column >= -1 && column < board.columns && row >= -1 && row < board.rows;
    return on_board && (column + row) % 2 == 0 ? 0.0F : 1.0F;
  });
}

/// Converts to the 8 bits of a camera.
inline cv::Mat in_8_bits(const cv::Mat& picture) {
  cv::Mat gray;
  picture.convertTo(gray, CV_8UC1, 180, 40);
  return gray;
}

/// Largest distance of a detected corner from the nearest true one (the board may be detected rotated).
inline double largest_error_px(const BoardView& found, const BoardView& truth) {
  double largest = 0;
  for (const auto& pixel : found.pixels) {
    double nearest = 1e9;
    for (const auto& other : truth.pixels) nearest = std::min(nearest, (pixel - other).norm());
    largest = std::max(largest, nearest);
  }
  return largest;
}

}  // namespace kinloop::test
