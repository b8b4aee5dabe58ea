#include "kinloop/geometry/trajectory.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

StampedPose parse_pose(const TextLine& line, const std::filesystem::path& path) {
  constexpr size_t kFields = 8;
  if (line.fields.size() != kFields) {
    throw_parse_error(
        path, line.number,
        fmt::format(
            "expected 'timestamp tx ty tz qx qy qz qw' (TUM format, separated by blanks), found {} fields",
            line.fields.size()));
  }
  const auto stamp_ns = parse_stamp_ns(line.fields[0]);
  if (!stamp_ns)
    throw_parse_error(
        path, line.number,
        fmt::format("'{}' is not a time stamp in seconds; correct or delete the line", line.fields[0]));
  double v[kFields - 1];
  for (size_t i = 0; i + 1 < kFields; ++i) v[i] = parse_double(line.fields[i + 1], path, line.number);
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  constexpr double kMinNorm = 1e-6;
  if (rotation.norm() < kMinNorm)
    throw_parse_error(path, line.number, "the quaternion is zero; correct or delete the line");
  return {*stamp_ns, {rotation.normalized(), {v[0], v[1], v[2]}}};
}

}  // namespace

std::vector<int64_t> stamps_of(const Trajectory& trajectory) {
  std::vector<int64_t> stamps_ns;
  for (const StampedPose& pose : trajectory) stamps_ns.push_back(pose.stamp_ns);
  return stamps_ns;
}

Trajectory read_tum_trajectory(const std::filesystem::path& path) {
  Trajectory trajectory;
  visit_table(path, [&](const TextLine& line) { trajectory.push_back(parse_pose(line, path)); });
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return trajectory;
}

void write_tum_trajectory(const std::filesystem::path& path, const Trajectory& trajectory,
                          std::string_view comment) {
  AtomicFile file(path);
  if (!comment.empty()) fmt::print(file.stream(), "# {}\n", comment);
  for (const auto& [stamp_ns, T] : trajectory) {
    const auto& t = T.translation;
    const auto& q = T.rotation;
    fmt::print(file.stream(), "{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", format_stamp(stamp_ns),
               t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  }
  file.commit();
}

std::optional<SE3> pose_at(const Trajectory& trajectory, int64_t stamp_ns, int64_t max_gap_ns) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), stamp_ns,
                       [](const StampedPose& pose, int64_t stamp) { return pose.stamp_ns < stamp; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->stamp_ns == stamp_ns) return after->T_world_camera;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = after - 1;
  const int64_t gap_ns = after->stamp_ns - before->stamp_ns;
  if (gap_ns > max_gap_ns) return std::nullopt;
  const double s = static_cast<double>(stamp_ns - before->stamp_ns) / static_cast<double>(gap_ns);
  return interpolate(before->T_world_camera, after->T_world_camera, s);
}

}  // namespace kinloop
