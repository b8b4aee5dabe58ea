#pragma once
// The frame of exported clouds and meshes. Internally everything is in the world frame, which is the first
// camera's (y down); files are upright, as other programs expect.

#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// The rotation of a file's coordinates relative to the world frame.
struct FileFrame {
  bool z_up = false;  ///< false: the world frame itself
  Eigen::Quaterniond R_file_world = Eigen::Quaterniond::Identity();

  [[nodiscard]] Eigen::Vector3f to_file(const Eigen::Vector3f& v_world) const {
    return z_up ? Eigen::Vector3f((R_file_world * v_world.cast<double>()).cast<float>()) : v_world;
  }
  [[nodiscard]] SE3 T_file_world() const {
    return {z_up ? R_file_world : Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero()};
  }
};

/// Returns the frame with z along `up` in which the first camera looks along y.
FileFrame z_up_frame(const Eigen::Vector3d& up, const SE3& T_world_first);

/// Describes the frame in comment lines; readers recover the world frame by the inverse rotation.
std::vector<std::string> format_frame_comments(const FileFrame& frame);

/// Parses such comment lines; returns the world frame if there are none.
FileFrame parse_frame_comments(const std::vector<std::string>& comments);

/// "frame" and, unless it is the world, "rotation_xyzw": the quaternion from the world to the file.
nlohmann::json to_json(const FileFrame& frame);

}  // namespace kinloop
