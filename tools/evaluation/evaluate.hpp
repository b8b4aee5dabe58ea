#pragma once
// In: an estimated trajectory and ground truth, each in its own world frame. Out: their differences, computed
// exactly as the tools of the TUM RGB-D benchmark do (Sturm et al. 2012), or as evo does (Grupp 2017).

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/geometry/trajectory.hpp"
#include "tools/evaluation/alignment.hpp"

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

/// Absolute trajectory error: position errors after the best alignment.
struct AteResult {
  ErrorStatistics error_m;
  SE3 T_truth_estimate;  ///< the alignment, applied after `scale`
  double scale = 1;      ///< of the estimate; 1 unless it is estimated
  std::vector<PoseError> poses;
};

/// Interval of a relative pose error.
struct RpeDelta {
  enum class Unit { kSeconds, kFrames, kMeters };
  double amount = 1;
  Unit unit = Unit::kSeconds;
};

/// Parses "1s", "10f" (frames) or "0.5m"; nullopt if the text is none of them, or not above 0.
std::optional<RpeDelta> parse_rpe_delta(std::string_view text);

/// Returns what to say of a text that `parse_rpe_delta` refuses.
std::string rpe_delta_error(std::string_view text);

/// Returns "1 s", "10 f" or "0.5 m".
std::string to_string(const RpeDelta& delta);

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

/// How trajectories are compared.
struct EvaluationOptions {
  Alignment alignment = Alignment::kSe3;
  int64_t offset_ns = 0;  ///< added to the stamps of the estimate
  int64_t max_difference_ns = kMaxAssociationNs;
  Convention convention = Convention::kTum;
  std::vector<RpeDelta> rpe = {};  ///< further intervals, beside 1 s and 1 frame
};

/// A relative pose error that was asked for.
struct RpeOver {
  RpeDelta delta;
  std::optional<RpeResult> error;
};

/// All error measures.
struct Evaluation {
  AteResult ate;
  std::optional<RpeResult> rpe_second;  ///< over 1 s
  std::optional<RpeResult> rpe_frame;   ///< from each frame to the next
  std::vector<RpeOver> rpe;             ///< over EvaluationOptions::rpe
  int64_t offset_ns = 0;                ///< added to the stamps of the estimate
  Coverage coverage;
};

/// ATE as in evaluate_ate.py: closest pairs in time first, each pose used once, Umeyama's alignment, by
/// default without scale; or as evo_ape. nullopt if fewer than three poses have ground truth.
std::optional<AteResult> absolute_trajectory_error(const Trajectory& estimate, const Trajectory& truth,
                                                   const EvaluationOptions& options = {});

/// RPE as in evaluate_rpe.py --fixed_delta, but over all pairs instead of 10000 random ones; over metres, and
/// by the convention of evo, as evo_rpe --all_pairs. nullopt if fewer than two pairs have ground truth, or if
/// the poses are too sparse for the interval.
std::optional<RpeResult> relative_pose_error(const Trajectory& estimate, const Trajectory& truth,
                                             RpeDelta delta = {}, const EvaluationOptions& options = {});

/// Explains in one line why `relative_pose_error` returned nullopt.
std::string rpe_failure(const Trajectory& estimate, const RpeDelta& delta);

/// Estimates farther apart leave a gap in the coverage.
constexpr int64_t kMaxGapNs = 500'000'000;

/// Returns the fraction of the truth's time span in which successive estimates are at most `max_gap_ns`
/// apart.
Coverage compute_coverage(const Trajectory& estimate, const Trajectory& truth, int64_t max_gap_ns = kMaxGapNs,
                          int64_t max_difference_ns = kMaxAssociationNs);

/// Computes all measures; nullopt if there is no ATE.
std::optional<Evaluation> evaluate(const Trajectory& estimate, const Trajectory& truth,
                                   const EvaluationOptions& options = {});

/// Explains in one line why `evaluate` returned nullopt.
std::string evaluation_failure(const Trajectory& estimate, const Trajectory& truth,
                               const EvaluationOptions& options = {});

/// Returns the trajectory with `offset_ns` added to its stamps.
Trajectory shifted(Trajectory trajectory, int64_t offset_ns);

/// Returns the figures as written by `kinloop eval --json` and to run.json.
nlohmann::json to_json(const Evaluation& evaluation);

}  // namespace kinloop
