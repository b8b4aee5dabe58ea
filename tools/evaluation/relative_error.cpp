#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <fmt/format.h>

#include "kinloop/core/time.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

using Unit = RpeDelta::Unit;

/// Intervals that differ more from the asked one, relative to it, are others.
constexpr double kDeltaTolerance = 0.1;

/// Errors of single motions.
struct MotionErrors {
  std::vector<double> translations_m, rotations_deg;

  void add(const SE3& error) {
    translations_m.push_back(error.translation.norm());
    rotations_deg.push_back(error.angle_rad() * 180 / std::numbers::pi);
  }
};

/// Index of the pose closest in time, the earlier on ties; `trajectory` must not be empty. Distances are
/// compared in rounded seconds: 0.455005 deg on fr2_desk_orbslam2 depends on one pose that is midway.
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
  const size_t to = delta.unit == Unit::kSeconds
                        ? closest_index(estimate, estimate[from].stamp_ns + to_ns(delta.amount))
                        : from + static_cast<size_t>(std::lround(delta.amount));
  return to + 1 < estimate.size() ? std::optional(to) : std::nullopt;
}

/// Whether most poses have another one about `delta` later. Else the motion over other times would be taken
/// for that over the asked one, as from a pose to itself.
bool is_dense_enough(const Trajectory& estimate, const RpeDelta& delta) {
  if (delta.unit != Unit::kSeconds) return true;
  size_t ends = 0, on_time = 0;
  for (size_t from = 0; from < estimate.size(); ++from) {
    const auto to = interval_end(estimate, from, delta);
    if (!to) continue;
    ++ends;
    const double interval_s = to_seconds(estimate[*to].stamp_ns - estimate[from].stamp_ns);
    if (std::abs(interval_s - delta.amount) <= kDeltaTolerance * delta.amount) ++on_time;
  }
  return 2 * on_time >= ends;
}

double median_interval_ns(const Trajectory& trajectory) {
  std::vector<double> intervals_ns;
  for (size_t i = 1; i < trajectory.size(); ++i) {
    intervals_ns.push_back(static_cast<double>(trajectory[i].stamp_ns - trajectory[i - 1].stamp_ns));
  }
  return compute_statistics(intervals_ns).median;
}

/// Ground truth farther away than twice its usual interval is not used for a pose, as by the TUM tool; nor is
/// one so far away that the camera has moved on.
int64_t max_truth_distance_ns(const Trajectory& truth, int64_t max_difference_ns) {
  constexpr int64_t kFarNs = 100'000'000;
  const int64_t usual_ns = std::llround(2 * median_interval_ns(truth));
  return std::min(usual_ns, std::max(kFarNs, max_difference_ns));
}

std::optional<SE3> truth_at(const Trajectory& truth, int64_t stamp_ns, int64_t max_distance_ns) {
  const StampedPose& closest = truth[closest_index(truth, stamp_ns)];
  if (std::abs(closest.stamp_ns - stamp_ns) > max_distance_ns) return std::nullopt;
  return closest.T_world_camera;
}

/// As evaluate_rpe.py: intervals of the estimate, each of whose ends has the closest true pose.
MotionErrors errors_of_tum(const Trajectory& estimate, const Trajectory& truth, const RpeDelta& delta,
                           int64_t max_difference_ns) {
  MotionErrors errors;
  const int64_t max_distance_ns = max_truth_distance_ns(truth, max_difference_ns);
  for (size_t from = 0; from < estimate.size(); ++from) {
    const auto to = interval_end(estimate, from, delta);
    if (!to || *to == from) continue;
    const auto truth_from = truth_at(truth, estimate[from].stamp_ns, max_distance_ns);
    const auto truth_to = truth_at(truth, estimate[*to].stamp_ns, max_distance_ns);
    if (!truth_from || !truth_to) continue;

    // Eq. (1) of Sturm et al. 2012, with the inverse motion as in the tool: its translation is expressed at
    // the other end, and so differs.
    const SE3 motion = estimate[*to].T_world_camera.inverse() * estimate[from].T_world_camera;
    errors.add(motion.inverse() * (truth_to->inverse() * *truth_from));
  }
  return errors;
}

/// How far along the unit of `delta` each pose is: path length, time or number of frames.
std::vector<double> positions_along(const Trajectory& path, Unit unit) {
  std::vector<double> along;
  for (size_t i = 0; i < path.size(); ++i) {
    if (unit == Unit::kFrames) along.push_back(static_cast<double>(i));
    if (unit == Unit::kSeconds) along.push_back(to_seconds(path[i].stamp_ns - path[0].stamp_ns));
    if (unit != Unit::kMeters) continue;
    const auto step_m = [&] {
      return (path[i].T_world_camera.translation - path[i - 1].T_world_camera.translation).norm();
    };
    along.push_back(i == 0 ? 0 : along.back() + step_m());
  }
  return along;
}

/// The first later pose that is closest to `amount` after `from`; nullopt if it is off by more than
/// `tolerance`.
std::optional<size_t> closest_after(const std::vector<double>& along, size_t from, double amount,
                                    double tolerance) {
  const auto gone = [&](size_t i) { return along[i] - along[from]; };
  size_t low = from + 1, high = along.size();
  if (low == high) return std::nullopt;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (gone(middle) < amount) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  const auto off = [&](size_t i) { return std::abs(gone(i) - amount); };
  size_t best = std::min(low, along.size() - 1);
  if (best > from + 1 && off(best - 1) <= off(best)) --best;
  while (best > from + 1 && off(best - 1) == off(best)) --best;  // a camera that stood still
  return off(best) <= tolerance ? std::optional(best) : std::nullopt;
}

/// As evo_rpe --all_pairs: intervals of the estimated poses that have a true one.
MotionErrors errors_of_evo(const Trajectory& estimate, const Trajectory& truth, const RpeDelta& delta,
                           const std::vector<StampPair>& pairs) {
  Trajectory matched, true_poses;
  for (const StampPair& pair : pairs) {
    matched.push_back(estimate[pair.b]);
    true_poses.push_back(truth[pair.a]);
  }
  const auto along = positions_along(matched, delta.unit);
  const double tolerance = delta.unit == Unit::kFrames ? 0 : kDeltaTolerance * delta.amount;
  MotionErrors errors;
  for (size_t from = 0; from + 1 < matched.size(); ++from) {
    const auto to = closest_after(along, from, delta.amount, tolerance);
    if (!to) continue;
    const auto motion = [&](const Trajectory& of) {
      return of[from].T_world_camera.inverse() * of[*to].T_world_camera;
    };
    errors.add(motion(true_poses).inverse() * motion(matched));
  }
  return errors;
}

}  // namespace

std::optional<RpeDelta> parse_rpe_delta(std::string_view text) {
  if (text.empty()) return std::nullopt;
  RpeDelta delta;
  switch (text.back()) {
    case 's':
      delta.unit = Unit::kSeconds;
      break;
    case 'f':
      delta.unit = Unit::kFrames;
      break;
    case 'm':
      delta.unit = Unit::kMeters;
      break;
    default:
      return std::nullopt;
  }
  constexpr double kMost = 1e6;
  const auto amount_e9 = parse_stamp_ns(text.substr(0, text.size() - 1));
  if (!amount_e9) return std::nullopt;
  delta.amount = rounded_seconds(*amount_e9);
  if (!(delta.amount > 0) || delta.amount > kMost) return std::nullopt;
  if (delta.unit == Unit::kFrames && delta.amount != std::floor(delta.amount)) return std::nullopt;
  return delta;
}

std::string rpe_delta_error(std::string_view text) {
  return fmt::format("'{}' is not an interval such as 1s, 10f (frames) or 0.5m", text);
}

std::string to_string(const RpeDelta& delta) {
  const char* unit = delta.unit == Unit::kSeconds ? "s" : delta.unit == Unit::kFrames ? "f" : "m";
  return fmt::format("{} {}", delta.amount, unit);
}

std::optional<RpeResult> relative_pose_error(const Trajectory& estimate, const Trajectory& truth,
                                             RpeDelta delta, const EvaluationOptions& options) {
  const Trajectory moved = shifted(estimate, options.offset_ns);
  if (truth.size() < 2 || !is_dense_enough(moved, delta)) return std::nullopt;
  const bool as_tum = options.convention == Convention::kTum && delta.unit != Unit::kMeters;
  const MotionErrors errors =
      as_tum ? errors_of_tum(moved, truth, delta, options.max_difference_ns)
             : errors_of_evo(moved, truth, delta,
                             pair_poses(moved, truth, options.max_difference_ns, options.convention));
  constexpr size_t kMinPairs = 2;
  if (errors.translations_m.size() < kMinPairs) return std::nullopt;
  return RpeResult{compute_statistics(errors.translations_m), compute_statistics(errors.rotations_deg)};
}

std::string rpe_failure(const Trajectory& estimate, const RpeDelta& delta) {
  if (!is_dense_enough(estimate, delta))
    return fmt::format("the poses are too sparse: {:.3g} s apart (median)",
                       1e-9 * median_interval_ns(estimate));
  return fmt::format("fewer than two motions over {} have ground truth at both ends", to_string(delta));
}

}  // namespace kinloop
