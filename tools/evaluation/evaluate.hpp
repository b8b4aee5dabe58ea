#pragma once
// In: an estimated trajectory and ground truth, each in its own world frame. Out: their differences, computed
// exactly as the tools of the TUM RGB-D benchmark do (Sturm et al. 2012).

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/core/association.hpp"
#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// Statistics of errors, in their unit; all zero if there are none.
struct ErrorStatistics {
  size_t count = 0;
  double rmse = 0;
  double mean = 0;
  double median = 0;
  double std = 0;  ///< of the population (divided by count, as numpy.std)
  double min = 0;
  double max = 0;
};

/// Computes the statistics of `errors`, in any order.
ErrorStatistics compute_statistics(std::span<const double> errors);

/// The error of one associated pose.
struct PoseError {
  int64_t stamp_ns = 0;  ///< of the estimate
  double error_m = 0;
};

/// Absolute trajectory error: position errors after the best rigid alignment.
struct AteResult {
  ErrorStatistics error_m;
  SE3 T_truth_estimate;  ///< the alignment (no scale)
  std::vector<PoseError> poses;
};

/// Interval of a relative pose error.
struct RpeDelta {
  enum class Unit { kSeconds, kFrames };
  double amount = 1;
  Unit unit = Unit::kSeconds;
};

/// Relative pose error over a fixed interval, a measure of drift.
struct RpeResult {
  ErrorStatistics translation_m;
  ErrorStatistics rotation_deg;
};

/// Fraction of the ground truth covered by the estimate.
struct Coverage {
  double time_fraction = 0;     ///< of the truth's time span, minus gaps in the estimate
  double matched_fraction = 0;  ///< of the estimated poses, those with a ground truth stamp in tolerance
};

/// All error measures.
struct Evaluation {
  AteResult ate;
  std::optional<RpeResult> rpe_second;  ///< over 1 s
  std::optional<RpeResult> rpe_frame;   ///< from each frame to the next
  Coverage coverage;
};

/// ATE as in evaluate_ate.py: closest pairs in time first, each pose used once, Horn's alignment without
/// scale. nullopt if fewer than three poses have ground truth or all of them are collinear.
std::optional<AteResult> absolute_trajectory_error(const Trajectory& estimate, const Trajectory& truth,
                                                   int64_t max_difference_ns = kMaxAssociationNs);

/// RPE as in evaluate_rpe.py --fixed_delta, but over all pairs instead of 10000 random ones. nullopt if fewer
/// than two pairs have ground truth.
std::optional<RpeResult> relative_pose_error(const Trajectory& estimate, const Trajectory& truth,
                                             RpeDelta delta = {});

/// Returns the fraction of the truth's time span in which successive estimates are at most `max_gap_ns`
/// apart.
Coverage compute_coverage(const Trajectory& estimate, const Trajectory& truth,
                          int64_t max_gap_ns = 500'000'000);

/// Computes all measures; nullopt if there is no ATE.
std::optional<Evaluation> evaluate(const Trajectory& estimate, const Trajectory& truth);

/// Explains in one line why `evaluate` returned nullopt.
std::string evaluation_failure(const Trajectory& estimate, const Trajectory& truth);

/// Returns the figures as written by `kinloop eval --json` and to run.json.
nlohmann::json to_json(const Evaluation& evaluation);

}  // namespace kinloop
