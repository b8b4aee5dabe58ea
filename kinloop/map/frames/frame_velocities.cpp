#include "kinloop/map/frames/frame_velocities.hpp"

#include <cmath>

#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

// Longer gaps say nothing about a handheld camera's velocity.
constexpr int64_t kMaxNeighbour_ns = 150'000'000;

}  // namespace

Velocity frame_velocity(const FrameLog& log, size_t i, const Map& map) {
  if (log[i].is_lost()) return {};
  // A repeated image carries no information about motion, so the frame that it repeats is used.
  size_t own = i, next = i + 1;
  const auto is_near = [&](size_t other) {
    return std::abs(log[i].stamp_ns - log[other].stamp_ns) < kMaxNeighbour_ns;
  };
  while (own > 0 && log[own].is_repeat() && is_near(own)) --own;
  while (next < log.size() && log[next].is_repeat() && is_near(next)) ++next;
  const auto usable = [&](size_t other) {
    return is_tracked_in(map.keyframe(log[i].reference).component, log[other], map) && is_near(other);
  };
  size_t previous = own > 0 ? own - 1 : own;
  while (previous > 0 && log[previous].is_repeat() && is_near(previous)) --previous;
  const size_t before = previous < own && usable(previous) ? previous : own;
  const size_t after = next < log.size() && usable(next) ? next : own;
  const int64_t duration_ns = log[after].stamp_ns - log[before].stamp_ns;
  if (duration_ns < kMinVelocityInterval_ns) return {};
  const SE3 T_world_before = log[before].world(map), T_world_after = log[after].world(map);
  const Eigen::Matrix3d R_camera_world = log[i].world(map).R().transpose();
  const double duration_s = to_seconds(duration_ns);
  return {R_camera_world * (T_world_after.translation - T_world_before.translation) / duration_s,
          log_so3(T_world_before.rotation.conjugate() * T_world_after.rotation) / duration_s};
}

std::vector<Velocity> frame_velocities(const FrameLog& log, const Map& map) {
  std::vector<Velocity> velocities(log.size());
  for (size_t i = 0; i < log.size(); ++i) velocities[i] = frame_velocity(log, i, map);
  return velocities;
}

std::vector<Velocity> keyframe_velocities(const FrameLog& log, const Map& map) {
  std::vector<Velocity> velocities(map.keyframes().size());
  for (size_t i = 0; i < log.size(); ++i) {
    if (log[i].keyframe.valid()) velocities[log[i].keyframe.value] = frame_velocity(log, i, map);
  }
  return velocities;
}

}  // namespace kinloop
