#pragma once
// Zhang's closed form: from views of a plane to the camera and its poses, without a start value.

#include <optional>
#include <span>

#include <Eigen/Core>

#include "kinloop/geometry/camera.hpp"
#include "tools/calibration/board.hpp"

namespace kinloop {

/// H with pixel ~ H * (x, y, 1) for points of a plane: the normalised direct linear transform (Hartley and
/// Zisserman 2004, algorithm 4.2), scaled to unit norm. Nothing for fewer than four points or points on a
/// line.
std::optional<Eigen::Matrix3d> fit_homography(std::span<const Eigen::Vector2d> plane,
                                              std::span<const Eigen::Vector2d> pixels);

/// fx, fy, cx, cy of a camera of `width` x `height` without distortion and skew from at least two
/// homographies (Zhang 2000, section 3.1). Nothing where the views do not fix them: all boards parallel, for
/// example.
std::optional<PinholeCamera> camera_from_homographies(std::span<const Eigen::Matrix3d> homographies,
                                                      int width, int height);

/// The pose of the plane that a camera without distortion sees through H (Zhang 2000, section 3.1), its
/// rotation the nearest one (appendix C).
SE3 pose_from_homography(const PinholeCamera& camera, const Eigen::Matrix3d& H);

/// T_camera_board of a view by a known camera, with its distortion taken out first. Nothing where the view
/// has no homography.
std::optional<SE3> board_pose(const PinholeCamera& camera, const BoardView& view);

}  // namespace kinloop
