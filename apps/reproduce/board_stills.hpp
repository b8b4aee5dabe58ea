#pragma once
// Stills of a chessboard as a known camera sees it, to calibrate without a camera.

#include <filesystem>

#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// A camera like the colour camera of a Kinect 2, at half its size.
PinholeCamera simulated_board_camera();

/// Draws `count` stills of a board of 5 x 7 inner corners and squares of 3 cm, 00.png and so on, tilted to
/// every side.
void draw_board_stills(const std::filesystem::path& folder, int count);

}  // namespace kinloop
