#include "kinloop/back_end/final/revise_doubt.hpp"

#include <algorithm>
#include <cstdlib>
#include <span>
#include <vector>

#include "kinloop/belief/hand_motion.hpp"
#include "kinloop/belief/relative_covariance.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/geometry/velocity.hpp"

namespace kinloop {
namespace {

/// Whether the motion before, as that of a hand, does not explain a pose.
bool jumps(const LoggedFrame& before, const LoggedFrame& previous, const LoggedFrame& entry, const Map& map) {
  const double baseline_s = to_seconds(previous.stamp_ns - before.stamp_ns);
  const double interval_s = to_seconds(entry.stamp_ns - previous.stamp_ns);
  if (!(baseline_s > 0)) return false;
  const SE3 T_world_previous = previous.world(map);
  const Velocity velocity = velocity_between(before.world(map), T_world_previous, baseline_s);
  return !is_explained({propagate_pose(T_world_previous, velocity, interval_s),
                        hand_motion_covariance(interval_s, baseline_s)},
                       entry.world(map));
}

/// One of two poses that jump is wrong, and perhaps both are.
void doubt_jumps(FrameLog& log, size_t first, const Map& map) {
  for (size_t i = first + 2; i < log.size(); ++i) {
    const LoggedFrame &before = log[i - 2], &previous = log[i - 1], &entry = log[i];
    const auto unmeasured = [](const LoggedFrame& frame) { return frame.is_lost() || frame.is_repeat(); };
    if (unmeasured(before) || unmeasured(previous) || unmeasured(entry)) continue;
    const uint32_t component = map.keyframe(entry.reference).component;
    if (!is_tracked_in(component, before, map) || !is_tracked_in(component, previous, map)) continue;
    if (!jumps(before, previous, entry, map)) continue;
    doubt(log[i - 1], DoubtCause::kJump);
    doubt(log[i], DoubtCause::kJump);
  }
}

/// The share of what has not moved that contradicts the pose.
double contradicted_share(const LoggedFrame& entry) {
  const SurfaceAgreement& surfaces = entry.evidence.surfaces;
  return surfaces.decides() ? surfaces.contradicted_share() : 0;
}

/// The share of the view that has moved or contradicts the pose.
double conflicting_share(const LoggedFrame& entry) {
  const double moved = entry.evidence.moved_share;
  return moved + (1 - moved) * contradicted_share(entry);
}

/// The mean of a share over the 1/3 s before or after each frame, whichever is less: what begins or ends at a
/// frame does not reach beyond it.
std::vector<double> lasting(std::span<const LoggedFrame> log, size_t first,
                            double (&share)(const LoggedFrame&)) {
  constexpr int64_t kWindow_ns = kNsPerSecond / 3;
  std::vector<double> sums(first + 1, 0);  // of the frames before each one
  for (size_t i = first; i < log.size(); ++i) sums.push_back(sums.back() + share(log[i]));
  const auto mean = [&](size_t begin, size_t end) {
    return (sums[end] - sums[begin]) / static_cast<double>(end - begin);
  };
  std::vector<double> means(log.size(), 0);
  size_t begin = first, end = first;
  for (size_t i = first; i < log.size(); ++i) {
    while (end < log.size() && log[end].stamp_ns <= log[i].stamp_ns + kWindow_ns) ++end;
    while (log[begin].stamp_ns < log[i].stamp_ns - kWindow_ns) ++begin;
    means[i] = std::min(mean(begin, i + 1), mean(i, end));
  }
  return means;
}

/// The doubtful and lost frames that do not stand alone.
std::vector<size_t> lasting_doubt(const FrameLog& log, size_t first) {
  constexpr int64_t kMaxInterval_ns = kNsPerSecond / 2;
  std::vector<size_t> all, lasting;
  for (size_t i = first; i < log.size(); ++i) {
    if (log[i].is_doubtful() || log[i].is_lost()) all.push_back(i);
  }
  const auto is_near_next = [&](size_t k) {
    return k + 1 < all.size() && log[all[k + 1]].stamp_ns - log[all[k]].stamp_ns <= kMaxInterval_ns;
  };
  for (size_t k = 0; k < all.size(); ++k) {
    if (is_near_next(k) || (k > 0 && is_near_next(k - 1))) lasting.push_back(all[k]);
  }
  return lasting;
}

// How far doubt reaches.
constexpr int64_t kMaxDistance_ns = 2 * kNsPerSecond;
// Without movers, 99 % of the frames are below .042; where the camera follows one, it is .1 to .4.
constexpr double kMinConflict = 0.06;

void extend_doubt(FrameLog& log, size_t first) {
  const std::vector<double> conflict = lasting(log, first, conflicting_share);
  const auto reaches = [&](size_t seed, size_t i) {
    return conflict[i] > kMinConflict && std::abs(log[i].stamp_ns - log[seed].stamp_ns) <= kMaxDistance_ns;
  };
  for (const size_t seed : lasting_doubt(log, first)) {
    for (size_t i = seed + 1; i < log.size() && reaches(seed, i); ++i) doubt(log[i], DoubtCause::kNeighbours);
    for (size_t i = seed; i-- > first && reaches(seed, i);) doubt(log[i], DoubtCause::kNeighbours);
  }
}

}  // namespace

FrameLog revise_doubt(FrameLog log, size_t first, const Map& map) {
  doubt_jumps(log, first, map);
  extend_doubt(log, first);
  return log;
}

std::optional<size_t> contradiction_start(const FrameLog& log, size_t first, size_t last) {
  size_t earliest = last;
  while (earliest > first && log[last].stamp_ns - log[earliest - 1].stamp_ns <= kMaxDistance_ns) --earliest;
  const std::vector<double> contradicted =
      lasting(std::span(log).subspan(earliest, last + 1 - earliest), 0, contradicted_share);
  size_t begin = last + 1;
  while (begin > earliest && contradicted[begin - 1 - earliest] > kMinConflict) --begin;
  return begin <= last ? std::optional(begin) : std::nullopt;
}

}  // namespace kinloop
