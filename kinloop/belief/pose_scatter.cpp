#include "kinloop/belief/pose_scatter.hpp"

#include <algorithm>
#include <cmath>

namespace kinloop {
namespace {

constexpr int64_t kMaxGap_ns = 500'000'000;
// Poses on either side over which the scatter is averaged: enough of them for six dimensions, but so few that
// a fast turn is not averaged with a rest.
constexpr size_t kFrames = 15, kKeyframes = 4;

/// Whether a pose scatters: one of dense alignment is chained to the previous one, and a repeated one is
/// none.
bool has_own_pose(const LoggedFrame& entry) {
  return entry.is_tracked_by_landmarks() && !entry.is_repeat();
}

std::optional<Vector6d> off_neighbours(std::span<const LoggedFrame> log, size_t i, const Map& map) {
  if (i == 0 || i + 1 == log.size() || !has_own_pose(log[i])) return std::nullopt;
  const uint32_t component = map.keyframe(log[i].reference).component;
  const auto usable = [&](const LoggedFrame& entry) {
    return has_own_pose(entry) && is_tracked_in(component, entry, map);
  };
  if (!usable(log[i - 1]) || !usable(log[i + 1])) return std::nullopt;
  const auto pose = [&](size_t k) { return StampedPose{log[k].stamp_ns, log[k].world(map)}; };
  return off_constant_motion(pose(i - 1), pose(i), pose(i + 1));
}

/// Returns for each of `frames` the mean of x x' over the nearest `reach` of them on either side.
void average(const std::vector<std::optional<Vector6d>>& off, const std::vector<size_t>& frames, size_t reach,
             std::vector<Matrix6d>& scatter) {
  for (size_t k = 0; k < frames.size(); ++k) {
    const size_t first = k - std::min(k, reach), last = std::min(k + reach + 1, frames.size());
    Matrix6d sum = Matrix6d::Zero();
    int count = 0;
    for (size_t other = first; other < last; ++other) {
      const auto& x = off[frames[other]];
      if (!x) continue;
      sum += *x * x->transpose();
      ++count;
    }
    if (count > 0) scatter[frames[k]] = sum / count;
  }
}

}  // namespace

std::optional<Vector6d> off_constant_motion(const StampedPose& before, const StampedPose& at,
                                            const StampedPose& after) {
  const auto to_at_ns = at.stamp_ns - before.stamp_ns, to_after_ns = after.stamp_ns - at.stamp_ns;
  if (to_at_ns <= 0 || to_after_ns <= 0 || std::max(to_at_ns, to_after_ns) > kMaxGap_ns) return std::nullopt;
  const SE3 T_at_world = at.T_world_camera.inverse();
  const Vector6d x_before = (T_at_world * before.T_world_camera).log();
  const Vector6d x_after = (T_at_world * after.T_world_camera).log();
  const double share = static_cast<double>(to_at_ns) / static_cast<double>(to_at_ns + to_after_ns);
  const double variances = 1 + share * share + (1 - share) * (1 - share);
  return ((1 - share) * x_before + share * x_after) / std::sqrt(variances);
}

std::vector<Matrix6d> pose_scatter(std::span<const LoggedFrame> log, const Map& map) {
  std::vector<std::optional<Vector6d>> off(log.size());
  std::vector<size_t> all(log.size()), keyframes;
  for (size_t i = 0; i < log.size(); ++i) {
    off[i] = off_neighbours(log, i, map);
    all[i] = i;
    if (log[i].keyframe.valid()) keyframes.push_back(i);
  }
  std::vector<Matrix6d> scatter(log.size(), Matrix6d::Zero());
  average(off, all, kFrames, scatter);
  average(off, keyframes, kKeyframes, scatter);
  return scatter;
}

}  // namespace kinloop
