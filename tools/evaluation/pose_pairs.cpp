#include "tools/evaluation/pose_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

std::vector<double> seconds_of(const Trajectory& trajectory) {
  std::vector<double> stamps_s;
  for (const StampedPose& pose : trajectory) stamps_s.push_back(rounded_seconds(pose.stamp_ns));
  return stamps_s;
}

/// For each stamp of the shorter list the closest of the longer one, the earlier on ties; some may serve
/// twice. `found(i, j)` is called for indices into the shorter and the longer list.
template <class Found>
void for_each_closest(const std::vector<double>& shorter_s, const std::vector<double>& longer_s,
                      double max_difference_s, const Found& found) {
  for (size_t i = 0; i < shorter_s.size(); ++i) {
    const auto after = std::upper_bound(longer_s.begin(), longer_s.end(), shorter_s[i]);
    const auto next = std::min(static_cast<size_t>(after - longer_s.begin()), longer_s.size() - 1);
    const double to_next_s = longer_s[next] - shorter_s[i];
    if (next > 0 && shorter_s[i] - longer_s[next - 1] <= to_next_s) {
      if (shorter_s[i] - longer_s[next - 1] <= max_difference_s) found(i, next - 1);
    } else if (std::abs(to_next_s) <= max_difference_s) {
      found(i, next);
    }
  }
}

}  // namespace

double rounded_seconds(int64_t stamp_ns) {
  const int64_t whole_s = stamp_ns / kNsPerSecond;
  const auto fraction = static_cast<double>(stamp_ns % kNsPerSecond) / static_cast<double>(kNsPerSecond);
  return static_cast<double>(whole_s) + fraction;
}

std::vector<StampPair> pair_poses(const Trajectory& estimate, const Trajectory& truth,
                                  int64_t max_difference_ns, Convention convention) {
  if (convention == Convention::kTum)
    return associate_stamps(stamps_of(truth), stamps_of(estimate), max_difference_ns);
  std::vector<StampPair> pairs;
  if (estimate.empty() || truth.empty()) return pairs;
  const double max_difference_s = rounded_seconds(max_difference_ns);
  if (estimate.size() > truth.size()) {
    for_each_closest(seconds_of(truth), seconds_of(estimate), max_difference_s,
                     [&](size_t of_truth, size_t of_estimate) {
                       pairs.push_back({of_truth, of_estimate});
                     });
  } else {
    for_each_closest(seconds_of(estimate), seconds_of(truth), max_difference_s,
                     [&](size_t of_estimate, size_t of_truth) {
                       pairs.push_back({of_truth, of_estimate});
                     });
  }
  return pairs;
}

}  // namespace kinloop
