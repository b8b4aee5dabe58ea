#include "kinloop/geometry/trajectory.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ostream.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/core/time_unit.hpp"
#include "kinloop/geometry/ground_truth.hpp"

namespace kinloop {
namespace {

/// A line of a file, before the unit of the stamps is known.
struct WrittenPose {
  size_t line = 0;
  std::string stamp;
  SE3 T_world_camera;
};

void require_eight_fields(const TextLine& line, const std::filesystem::path& path) {
  constexpr size_t kFields = 8;
  if (line.fields.size() == kFields) return;
  throw_parse_error(
      path, line.number,
      fmt::format(
          "expected 'timestamp tx ty tz qx qy qz qw' (TUM format, separated by blanks), found {} fields",
          line.fields.size()));
}

WrittenPose parse_pose(const TextLine& line, const std::filesystem::path& path) {
  require_eight_fields(line, path);
  constexpr size_t kNumbers = 7;
  double v[kNumbers];
  for (size_t i = 0; i < kNumbers; ++i) v[i] = parse_double(line.fields[i + 1], path, line.number);
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  constexpr double kMinNorm = 1e-6;
  if (rotation.norm() < kMinNorm)
    throw_parse_error(path, line.number, "the quaternion is zero; correct or delete the line");
  return {line.number, line.fields[0], {rotation.normalized(), {v[0], v[1], v[2]}}};
}

/// False for NaN, infinity and a quaternion of zeros.
bool has_pose(const TextLine& line, const std::filesystem::path& path) {
  require_eight_fields(line, path);
  const auto number = [&](size_t field) {
    double value = 0;
    const std::string& text = line.fields[field];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? value
                                                                    : 1;  // parse_pose says what it is
  };
  bool rotation = false;
  for (size_t field = 1; field < line.fields.size(); ++field) {
    constexpr size_t kFirstOfQuaternion = 4;
    if (!std::isfinite(number(field))) return false;
    rotation = rotation || (field >= kFirstOfQuaternion && number(field) != 0);
  }
  return rotation;
}

/// Seconds, unless all stamps are Unix time in another unit, or whole numbers with the intervals of a camera
/// in micro- or nanoseconds.
std::optional<std::vector<int64_t>> stamps_in_other_unit(const std::vector<WrittenPose>& poses) {
  constexpr int64_t kMicrosecond_ns = 1000;
  std::vector<std::string> texts;
  for (const WrittenPose& pose : poses) texts.push_back(pose.stamp);
  const auto times = times_not_in_seconds(texts);
  const bool certain = times && (times->unit.from_clock || times->unit.ns <= kMicrosecond_ns);
  return certain ? std::optional(times->stamps_ns) : std::nullopt;
}

int64_t stamp_in_seconds(const WrittenPose& pose, const std::filesystem::path& path) {
  const auto stamp_ns = parse_stamp_ns(pose.stamp);
  if (!stamp_ns)
    throw_parse_error(
        path, pose.line,
        fmt::format("'{}' is not a time stamp in seconds; correct or delete the line", pose.stamp));
  return *stamp_ns;
}

Trajectory sorted_trajectory(const std::vector<WrittenPose>& poses, const std::filesystem::path& path) {
  const auto other = stamps_in_other_unit(poses);
  Trajectory trajectory;
  for (size_t i = 0; i < poses.size(); ++i) {
    const int64_t stamp_ns = other ? (*other)[i] : stamp_in_seconds(poses[i], path);
    trajectory.push_back({stamp_ns, poses[i].T_world_camera});
  }
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  return trajectory;
}

}  // namespace

std::vector<int64_t> stamps_of(const Trajectory& trajectory) {
  std::vector<int64_t> stamps_ns;
  for (const StampedPose& pose : trajectory) stamps_ns.push_back(pose.stamp_ns);
  return stamps_ns;
}

Trajectory read_tum_trajectory(const std::filesystem::path& path) {
  std::vector<WrittenPose> poses;
  visit_table(path, [&](const TextLine& line) { poses.push_back(parse_pose(line, path)); });
  return sorted_trajectory(poses, path);
}

Trajectory read_ground_truth(const std::filesystem::path& path) {
  std::vector<WrittenPose> poses;
  size_t without_pose = 0;
  visit_table(path, [&](const TextLine& line) {
    if (has_pose(line, path)) {
      poses.push_back(parse_pose(line, path));
    } else {
      ++without_pose;
    }
  });
  if (without_pose > 0)
    log::info("{}: {} of {} lines have no pose (NaN or zeros) and are not used", path.string(), without_pose,
              without_pose + poses.size());
  return sorted_trajectory(poses, path);
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
