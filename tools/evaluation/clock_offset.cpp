#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "kinloop/core/time.hpp"
#include "tools/evaluation/alignment.hpp"
#include "tools/evaluation/recognition.hpp"

namespace kinloop {
namespace {

constexpr int64_t kLongestGapNs = 500'000'000;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Speeds of a camera at regular times; NaN in gaps.
struct SpeedSignal {
  std::vector<double> turning, moving;
};

SpeedSignal speeds_of(const Trajectory& path, int64_t step_ns) {
  SpeedSignal signal;
  std::optional<SE3> before;
  for (int64_t stamp_ns = path.front().stamp_ns; stamp_ns <= path.back().stamp_ns; stamp_ns += step_ns) {
    const auto pose = pose_at(path, stamp_ns, kLongestGapNs);
    const bool known = before && pose;
    const SE3 motion = known ? before->inverse() * *pose : SE3();
    signal.turning.push_back(known ? motion.angle_rad() : kUnknown);
    signal.moving.push_back(known ? motion.translation.norm() : kUnknown);
    before = pose;
  }
  return signal;
}

/// Correlation coefficient of a[i + lag] and b[i]; nullopt if fewer than `min_overlap` pairs are known.
std::optional<double> correlation(const std::vector<double>& a, const std::vector<double>& b, int64_t lag,
                                  int64_t min_overlap) {
  const auto size_a = static_cast<int64_t>(a.size()), size_b = static_cast<int64_t>(b.size());
  double n = 0, sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0, sum_ab = 0;
  for (int64_t i = std::max<int64_t>(0, -lag); i < std::min(size_b, size_a - lag); ++i) {
    const double x = a[static_cast<size_t>(i + lag)], y = b[static_cast<size_t>(i)];
    if (std::isnan(x + y)) continue;
    n += 1, sum_a += x, sum_b += y;
    sum_aa += x * x, sum_bb += y * y, sum_ab += x * y;
  }
  if (n < static_cast<double>(min_overlap)) return std::nullopt;
  const double variances = (sum_aa - sum_a * sum_a / n) * (sum_bb - sum_b * sum_b / n);
  return variances > 0 ? (sum_ab - sum_a * sum_b / n) / std::sqrt(variances) : 0;
}

/// The lag with the highest correlation of both speeds; nullopt if it is low or does not stand out.
std::optional<int64_t> best_lag(const SpeedSignal& truth, const SpeedSignal& estimate, int64_t min_overlap,
                                int64_t apart) {
  constexpr double kMinCorrelation = 0.7, kMinLead = 0.1;
  std::vector<std::pair<double, int64_t>> scores;
  const auto size_truth = static_cast<int64_t>(truth.turning.size());
  for (int64_t lag = -static_cast<int64_t>(estimate.turning.size()); lag < size_truth; ++lag) {
    const auto turning = correlation(truth.turning, estimate.turning, lag, min_overlap);
    if (!turning) continue;
    const auto moving = correlation(truth.moving, estimate.moving, lag, min_overlap);
    scores.emplace_back((*turning + moving.value_or(0)) / 2, lag);
  }
  if (scores.empty()) return std::nullopt;
  const auto [best, lag] = *std::max_element(scores.begin(), scores.end());
  if (best < kMinCorrelation) return std::nullopt;
  for (const auto& [score, other] : scores) {
    if (std::abs(other - lag) > apart && score > best - kMinLead) return std::nullopt;
  }
  return lag;
}

/// RMS position error after rigid alignment with the truth interpolated at the shifted times of some poses.
double position_error_m(const Trajectory& estimate, const Trajectory& truth, int64_t offset_ns) {
  constexpr size_t kPoses = 400;
  std::vector<SE3> true_poses, poses;
  const size_t step = std::max<size_t>(1, estimate.size() / kPoses);
  for (size_t i = 0; i < estimate.size(); i += step) {
    const auto pose = pose_at(truth, estimate[i].stamp_ns + offset_ns, kLongestGapNs);
    if (!pose) continue;
    true_poses.push_back(*pose);
    poses.push_back(estimate[i].T_world_camera);
  }
  const auto S = align_poses(true_poses, poses, Alignment::kSe3);
  if (!S) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (size_t i = 0; i < poses.size(); ++i)
    sum += (S->moved(poses[i]).translation - true_poses[i].translation).squaredNorm();
  return std::sqrt(sum / static_cast<double>(poses.size()));
}

/// Golden section search around `offset_ns`.
int64_t refined(const Trajectory& estimate, const Trajectory& truth, int64_t offset_ns, int64_t reach_ns) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr double kPrecisionNs = 1e5;
  double low = static_cast<double>(offset_ns - reach_ns), high = static_cast<double>(offset_ns + reach_ns);
  const auto error_m = [&](double at_ns) { return position_error_m(estimate, truth, std::llround(at_ns)); };
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double error_a = error_m(a), error_b = error_m(b);
  while (high - low > kPrecisionNs) {
    if (error_a < error_b) {
      high = b, b = a, error_b = error_a;
      a = high - kGolden * (high - low), error_a = error_m(a);
    } else {
      low = a, a = b, error_a = error_b;
      b = low + kGolden * (high - low), error_b = error_m(b);
    }
  }
  return std::llround((low + high) / 2);
}

int64_t duration_ns(const Trajectory& path) {
  return path.back().stamp_ns - path.front().stamp_ns;
}

}  // namespace

std::optional<int64_t> estimate_clock_offset(const Trajectory& estimate, const Trajectory& truth) {
  constexpr int64_t kStepNs = 100'000'000, kMinOverlapNs = 3 * kNsPerSecond, kApartNs = kNsPerSecond;
  constexpr int64_t kMostSteps = 3000;  // of the longer trajectory, so that all lags take less than a second
  constexpr int64_t kLongestNs = 1'000'000 * kNsPerSecond;
  if (estimate.size() < 3 || truth.size() < 3) return std::nullopt;
  const int64_t shorter_ns = std::min(duration_ns(estimate), duration_ns(truth));
  const int64_t longer_ns = std::max(duration_ns(estimate), duration_ns(truth));
  if (shorter_ns < kMinOverlapNs || longer_ns > kLongestNs) return std::nullopt;
  const int64_t step_ns = std::max(kStepNs, longer_ns / kMostSteps);
  const int64_t min_overlap = std::max(kMinOverlapNs, shorter_ns / 2) / step_ns;
  const auto lag = best_lag(speeds_of(truth, step_ns), speeds_of(estimate, step_ns), min_overlap,
                            std::max<int64_t>(2, kApartNs / step_ns));
  if (!lag) return std::nullopt;
  const int64_t offset_ns = truth.front().stamp_ns - estimate.front().stamp_ns + *lag * step_ns;
  return refined(estimate, truth, offset_ns, step_ns);
}

}  // namespace kinloop
