#pragma once
// Zhang's closed-form solution: from views of a plane to the camera and its poses, without initial values.

#include <optional>
#include <span>

#include <Eigen/Core>

#include "kinloop/geometry/camera.hpp"
#include "tools/calibration/board/board.hpp"

namespace kinloop {

/// Returns H with pixel ~ H * (x, y, 1) for points of a plane: the normalised direct linear transform
/// (Hartley and Zisserman 2004, algorithm 4.2), scaled to unit norm. nullopt for fewer than four points or
/// collinear points.
std::optional<Eigen::Matrix3d> fit_homography(std::span<const Eigen::Vector2d> plane,
                                              std::span<const Eigen::Vector2d> pixels);

/// Returns fx, fy, cx, cy of a camera of `width` x `height` without distortion and skew from at least two
/// homographies (Zhang 2000, section 3.1). nullopt if the views do not determine them, e.g. if all boards are
/// parallel.
std::optional<PinholeCamera> camera_from_homographies(std::span<const Eigen::Matrix3d> homographies,
                                                      int width, int height);

/// Returns the pose of the plane that an undistorted camera sees through H (Zhang 2000, section 3.1), with
/// the nearest rotation (appendix C).
SE3 pose_from_homography(const PinholeCamera& camera, const Eigen::Matrix3d& H);

/// Returns T_camera_board of a view by a calibrated camera, after undistorting it. nullopt if the view has no
/// homography.
std::optional<SE3> board_pose(const PinholeCamera& camera, const BoardView& view);

}  // namespace kinloop
