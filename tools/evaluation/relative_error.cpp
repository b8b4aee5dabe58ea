#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "kinloop/core/time.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

/// Seconds as the TUM tools store them: a double resolves 0.24 us of Unix time.
double rounded_seconds(int64_t stamp_ns) {
  const int64_t whole_s = stamp_ns / kNsPerSecond;
  const auto fraction = static_cast<double>(stamp_ns % kNsPerSecond) / static_cast<double>(kNsPerSecond);
  return static_cast<double>(whole_s) + fraction;
}

/// Index of the pose closest in time, the earlier on ties; `trajectory` must not be empty. Distances are
/// compared in rounded seconds: stamps of four decimals often lie exactly midway, where the tool's result
/// depends on rounding (0.455005 deg on fr2_desk_orbslam2 depends on one such pair).
size_t closest_index(const Trajectory& trajectory, int64_t stamp_ns) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), stamp_ns,
                       [](const StampedPose& pose, int64_t stamp) { return pose.stamp_ns < stamp; });
  const auto index = static_cast<size_t>(after - trajectory.begin());
  if (index == 0) return 0;
  if (index == trajectory.size()) return index - 1;
  const double stamp_s = rounded_seconds(stamp_ns);
  const double before_s = stamp_s - rounded_seconds(trajectory[index - 1].stamp_ns);
  return before_s <= rounded_seconds(trajectory[index].stamp_ns) - stamp_s ? index - 1 : index;
}

/// The pose that closes the interval starting at pose `from`; nullopt if that is the last pose: the TUM tool
/// omits it, since it is also the closest one to every time after the end.
std::optional<size_t> interval_end(const Trajectory& estimate, size_t from, const RpeDelta& delta) {
  const size_t to = delta.unit == RpeDelta::Unit::kSeconds
                        ? closest_index(estimate, estimate[from].stamp_ns + to_ns(delta.amount))
                        : from + static_cast<size_t>(std::lround(delta.amount));
  return to + 1 < estimate.size() ? std::optional(to) : std::nullopt;
}

/// Ground truth farther away than twice its usual interval is not used for a pose.
int64_t max_truth_distance_ns(const Trajectory& truth) {
  std::vector<double> intervals_ns;
  for (size_t i = 1; i < truth.size(); ++i) {
    intervals_ns.push_back(static_cast<double>(truth[i].stamp_ns - truth[i - 1].stamp_ns));
  }
  return std::llround(2 * compute_statistics(intervals_ns).median);
}

std::optional<SE3> truth_at(const Trajectory& truth, int64_t stamp_ns, int64_t max_distance_ns) {
  const StampedPose& closest = truth[closest_index(truth, stamp_ns)];
  if (std::abs(closest.stamp_ns - stamp_ns) > max_distance_ns) return std::nullopt;
  return closest.T_world_camera;
}

}  // namespace

std::optional<RpeResult> relative_pose_error(const Trajectory& estimate, const Trajectory& truth,
                                             RpeDelta delta) {
  if (truth.size() < 2) return std::nullopt;
  const int64_t max_distance_ns = max_truth_distance_ns(truth);
  std::vector<double> translations_m, rotations_deg;
  for (size_t from = 0; from < estimate.size(); ++from) {
    const auto to = interval_end(estimate, from, delta);
    if (!to) continue;
    const auto truth_from = truth_at(truth, estimate[from].stamp_ns, max_distance_ns);
    const auto truth_to = truth_at(truth, estimate[*to].stamp_ns, max_distance_ns);
    if (!truth_from || !truth_to) continue;

    // Eq. (1) of Sturm et al. 2012, with the inverse motion as in the tool: its translation is expressed at
    // the other end, and so differs.
    const SE3 motion = estimate[*to].T_world_camera.inverse() * estimate[from].T_world_camera;
    const SE3 true_motion = truth_to->inverse() * *truth_from;
    const SE3 error = motion.inverse() * true_motion;
    translations_m.push_back(error.translation.norm());
    rotations_deg.push_back(error.angle_rad() * 180 / std::numbers::pi);
  }
  constexpr size_t kMinPairs = 2;
  if (translations_m.size() < kMinPairs) return std::nullopt;
  return RpeResult{compute_statistics(translations_m), compute_statistics(rotations_deg)};
}

}  // namespace kinloop
