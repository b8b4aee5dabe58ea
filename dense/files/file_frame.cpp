#include "dense/files/file_frame.hpp"

#include <cmath>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dense/up_direction.hpp"

namespace kinloop {
namespace {

constexpr const char* kRotation = "rotation_xyzw";

}  // namespace

FileFrame z_up_frame(const Eigen::Vector3d& up, const SE3& T_world_first) {
  return {true, upright_rotation(up, T_world_first)};
}

std::vector<std::string> format_frame_comments(const FileFrame& frame) {
  if (!frame.z_up)
    return {"frame camera: the first camera's, x right, y down, z ahead; that of trajectory.txt"};
  const Eigen::Quaterniond& q = frame.R_file_world;
  return {"frame z-up: that of trajectory.txt turned by the quaternion x y z w below",
          fmt::format("{} {} {} {} {}", kRotation, q.x(), q.y(), q.z(), q.w())};
}

FileFrame parse_frame_comments(const std::vector<std::string>& comments) {
  constexpr double kTolerance = 1e-3;
  for (const std::string& comment : comments) {
    std::istringstream words(comment);
    std::string key;
    double x = 0, y = 0, z = 0, w = 0;
    if (!(words >> key >> x >> y >> z >> w) || key != kRotation) continue;
    const Eigen::Quaterniond q(w, x, y, z);
    if (std::abs(q.norm() - 1) < kTolerance) return {true, q.normalized()};
  }
  return {};
}

nlohmann::json to_json(const FileFrame& frame) {
  if (!frame.z_up) return {{"frame", "camera"}};
  const Eigen::Quaterniond& q = frame.R_file_world;
  return {{"frame", "z-up"}, {kRotation, {q.x(), q.y(), q.z(), q.w()}}};
}

}  // namespace kinloop
