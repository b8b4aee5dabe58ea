#pragma once
// The frame in which clouds and meshes are written. Inside kinloop everything is in the map's world, which is
// the first camera's (y down); files are upright, so that other programs show them so.

#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// What a file's coordinates are: those of the world, turned.
struct FileFrame {
  bool z_up = false;  ///< else the world itself
  Eigen::Quaterniond R_file_world = Eigen::Quaterniond::Identity();

  [[nodiscard]] Eigen::Vector3f to_file(const Eigen::Vector3f& v_world) const {
    return z_up ? Eigen::Vector3f((R_file_world * v_world.cast<double>()).cast<float>()) : v_world;
  }
};

/// The frame with z along `up` in which the first camera looks along y.
FileFrame z_up_frame(const Eigen::Vector3d& up, const SE3& T_world_first);

/// What a file says of its frame, line by line: readers who want the world back turn by the inverse.
std::vector<std::string> format_frame_comments(const FileFrame& frame);

/// The frame that such lines tell of; the world where they do not.
FileFrame parse_frame_comments(const std::vector<std::string>& comments);

/// "frame" and, where it is not the world, "rotation_xyzw": the quaternion from the world to the file.
nlohmann::json to_json(const FileFrame& frame);

}  // namespace kinloop
