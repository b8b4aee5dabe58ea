#include "kinloop/slam/frame_velocities.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/base/quantile.hpp"
#include "kinloop/base/time.hpp"

namespace kinloop {
namespace {

constexpr int64_t kMaxNeighbour_ns = 150'000'000;  // farther apart, a hand's velocity has changed
constexpr double kSteady_s = 0.1;                  // for so long a hand keeps its velocity

constexpr double kLeastDoubt = 1e-3;  // m/s and rad/s

/// A velocity in world axes, and when.
struct Moving {
  double stamp_s = 0;
  Velocity velocity = Velocity::Zero();
};

/// Of the tracked frames that have a picture of their own.
std::vector<Moving> moving_frames(const FrameLog& log, const Map& map) {
  const auto velocities = frame_velocities(log, map);
  std::vector<Moving> moving;
  for (size_t i = 0; i < log.size(); ++i) {
    if (log[i].status == TrackStatus::kLost || log[i].repeat || velocities[i].isZero(0)) continue;
    const Eigen::Matrix3d R_world_camera = world_pose(log[i], map).R();
    Moving frame{to_seconds(log[i].stamp_ns), {}};
    frame.velocity << R_world_camera * velocities[i].head<3>(), R_world_camera * velocities[i].tail<3>();
    moving.push_back(frame);
  }
  return moving;
}

}  // namespace

std::vector<Velocity> frame_velocities(const FrameLog& log, const Map& map) {
  std::vector<Velocity> velocities(log.size(), Velocity::Zero());
  const auto usable = [&](size_t i, size_t other) {
    return tracked_in(map.keyframe(log[i].reference).component, log[other], map) &&
           std::abs(log[i].stamp_ns - log[other].stamp_ns) < kMaxNeighbour_ns;
  };
  for (size_t i = 0; i < log.size(); ++i) {
    if (log[i].status == TrackStatus::kLost) continue;
    // A repeated image says nothing of the motion between the two; the image itself was taken once.
    size_t own = i, next = i + 1;
    while (own > 0 && log[own].repeat) --own;
    while (next < log.size() && log[next].repeat) ++next;
    size_t previous = own > 0 ? own - 1 : own;
    while (previous > 0 && log[previous].repeat) --previous;
    const size_t before = previous < own && usable(own, previous) ? previous : own;
    const size_t after = next < log.size() && usable(own, next) ? next : own;
    const int64_t duration_ns = log[after].stamp_ns - log[before].stamp_ns;
    if (duration_ns <= 0) continue;
    const SE3 T_world_before = world_pose(log[before], map), T_world_after = world_pose(log[after], map);
    const Eigen::Matrix3d R_camera_world = world_pose(log[i], map).R().transpose();
    const double duration_s = to_seconds(duration_ns);
    velocities[i] << R_camera_world * (T_world_after.translation - T_world_before.translation) / duration_s,
        log_so3(T_world_before.rotation.conjugate() * T_world_after.rotation) / duration_s;
  }
  return velocities;
}

std::vector<Velocity> keyframe_velocities(const FrameLog& log, const Map& map) {
  const auto of_frames = frame_velocities(log, map);
  std::vector<Velocity> velocities(map.keyframes().size(), Velocity::Zero());
  for (size_t i = 0; i < log.size(); ++i) {
    if (log[i].keyframe.valid()) velocities[log[i].keyframe.value] = of_frames[i];
  }
  return velocities;
}

std::optional<VelocitySigma> velocity_doubt(const FrameLog& log, const Map& map) {
  const std::vector<Moving> moving = moving_frames(log, map);
  std::vector<double> gaps_s, shift_changes, turn_changes;  // squared changes
  for (size_t i = 1; i + 1 < moving.size(); ++i) {
    const double gap_s = (moving[i + 1].stamp_s - moving[i - 1].stamp_s) / 2;
    if (gap_s > to_seconds(kMaxNeighbour_ns)) continue;
    const Velocity change = moving[i].velocity - (moving[i - 1].velocity + moving[i + 1].velocity) / 2;
    gaps_s.push_back(gap_s);
    shift_changes.push_back(change.head<3>().squaredNorm());
    turn_changes.push_back(change.tail<3>().squaredNorm());
  }
  if (gaps_s.empty() || median(std::move(gaps_s)) < kSteady_s) return std::nullopt;
  // The median of a squared length in three dimensions is 2.37 variances of each.
  constexpr double kMedianOfChi2 = 2.366;
  return VelocitySigma{std::sqrt(median(std::move(shift_changes)) / kMedianOfChi2),
                       std::sqrt(median(std::move(turn_changes)) / kMedianOfChi2)};
}

BundleOptions with_velocities(BundleOptions options, const FrameLog& log, const Map& map) {
  if (const auto doubt = velocity_doubt(log, map)) {
    options.free_velocities = true;
    options.velocity_sigma_m_s = std::max(doubt->m_s, kLeastDoubt);
    options.velocity_sigma_rad_s = std::max(doubt->rad_s, kLeastDoubt);
  }
  return options;
}

}  // namespace kinloop
