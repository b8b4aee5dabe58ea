#pragma once
// In: an estimated trajectory and ground truth, each in a world frame of its own. Out: how far they are
// apart, computed as the tools of the TUM RGB-D benchmark do (Sturm et al. 2012), digit for digit.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/base/association.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "tools/evaluation/statistics.hpp"

namespace kinloop {

/// The error of one associated pose.
struct PoseError {
  int64_t stamp_ns = 0;  ///< of the estimate
  double error_m = 0;
};

/// Absolute trajectory error: what is left between positions after the best rigid alignment.
struct AteResult {
  ErrorStatistics error_m;
  SE3 T_truth_estimate;  ///< the alignment (no scale)
  std::vector<PoseError> poses;
};

/// How far apart the two poses of a relative error are.
struct RpeDelta {
  enum class Unit { kSeconds, kFrames };
  double amount = 1;
  Unit unit = Unit::kSeconds;
};

/// Relative pose error: how far motions over a fixed interval are off, a measure of drift.
struct RpeResult {
  ErrorStatistics translation_m;
  ErrorStatistics rotation_deg;
};

/// How much of the ground truth has an estimate.
struct Coverage {
  double time_fraction = 0;     ///< of the truth's time span, less the gaps in the estimate
  double matched_fraction = 0;  ///< of the estimated poses, those with ground truth at their time
};

/// All of these.
struct Evaluation {
  AteResult ate;
  std::optional<RpeResult> rpe_second;  ///< over 1 s
  std::optional<RpeResult> rpe_frame;   ///< from each frame to the next
  Coverage coverage;
};

/// ATE as evaluate_ate.py: closest pairs in time first, each pose used once, Horn's alignment without scale.
/// Nothing when fewer than three poses have ground truth, or all of them lie on one line.
std::optional<AteResult> absolute_trajectory_error(const Trajectory& estimate, const Trajectory& truth,
                                                   int64_t max_difference_ns = kMaxAssociationNs);

/// RPE as evaluate_rpe.py --fixed_delta, but over all pairs where that tool draws 10000 at random. Nothing
/// when fewer than two pairs have ground truth.
std::optional<RpeResult> relative_pose_error(const Trajectory& estimate, const Trajectory& truth,
                                             RpeDelta delta = {});

/// Share of the truth's time span in which successive estimates are at most `max_gap_ns` apart.
Coverage compute_coverage(const Trajectory& estimate, const Trajectory& truth,
                          int64_t max_gap_ns = 500'000'000);

/// Everything at once; nothing when there is no ATE.
std::optional<Evaluation> evaluate(const Trajectory& estimate, const Trajectory& truth);

/// One line on why `evaluate` gave nothing.
std::string evaluation_failure(const Trajectory& estimate, const Trajectory& truth);

/// The figures as `kinloop eval --json` and run.json hold them.
nlohmann::json to_json(const Evaluation& evaluation);

}  // namespace kinloop
