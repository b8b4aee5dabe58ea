#pragma once
// In: text files with matrices (poses, intrinsics), as nearly all datasets have them. Out: poses and lenses.

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/types.hpp>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// ARKit's camera looks along -z with y up; ours along z with y down.
SE3 from_arkit(const SE3& T_world_arkit);

/// Returns the rigid motion of a 4x4 matrix; nullopt if it is not finite (datasets mark frames that lost
/// tracking with infinities) or not rigid.
std::optional<SE3> rigid_motion(const Eigen::Matrix4d& matrix);

/// Returns the matrix of 12 or 16 numbers in row order; nullopt for another count.
std::optional<Eigen::Matrix4d> matrix_of(std::span<const double> rows);

/// Returns the motion of tx ty tz qx qy qz qw; nullopt if it is not finite or the quaternion is zero.
std::optional<SE3> motion_of(std::span<const double> translation_quaternion);

/// Reads all numbers of a file separated by blanks, commas and line ends; "inf" and "nan" are numbers here.
/// Throws InputError naming file and line for anything else.
std::vector<double> read_numbers(const std::filesystem::path& file);

/// Reads a file of one matrix of at least 12 numbers. Throws InputError naming the file.
Eigen::Matrix4d read_matrix(const std::filesystem::path& file);

/// Reads fx, fy, cx, cy from a file with a 3x3 or 4x4 matrix of intrinsics. Throws InputError naming the
/// file.
PinholeCamera read_lens(const std::filesystem::path& file, cv::Size size);

/// Returns the lens with the intrinsics of a matrix. Throws InputError naming `file` unless they are
/// plausible for the size.
PinholeCamera checked_lens(const PinholeCamera& lens, const std::filesystem::path& file);

/// Returns whether an image can have this size.
bool is_plausible_size(double width, double height);

/// Returns the size of an image. Throws InputError naming `file` unless it is one.
cv::Size checked_size(double width, double height, const std::filesystem::path& file);

/// Makes a camera without distortion.
PinholeCamera make_lens(cv::Size size, double fx, double fy, double cx, double cy);

}  // namespace kinloop
