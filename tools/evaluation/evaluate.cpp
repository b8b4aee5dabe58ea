#include "tools/evaluation/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "kinloop/core/time.hpp"

namespace kinloop {

ErrorStatistics compute_statistics(std::span<const double> errors) {
  if (errors.empty()) return {};
  std::vector<double> sorted(errors.begin(), errors.end());
  std::sort(sorted.begin(), sorted.end());
  const auto n = static_cast<double>(sorted.size());

  double sum = 0, sum_of_squares = 0;
  for (const double error : sorted) {
    sum += error;
    sum_of_squares += error * error;
  }
  const double mean = sum / n;
  double deviations = 0;
  for (const double error : sorted) deviations += (error - mean) * (error - mean);

  const size_t middle = sorted.size() / 2;
  return {.count = sorted.size(),
          .rmse = std::sqrt(sum_of_squares / n),
          .mean = mean,
          .median = sorted.size() % 2 == 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2,
          .std = std::sqrt(deviations / n),
          .min = sorted.front(),
          .max = sorted.back()};
}

namespace {

std::string span_text(const Trajectory& trajectory) {
  if (trajectory.empty()) return "is empty";
  return fmt::format("lasts from {} to {}", format_stamp(trajectory.front().stamp_ns),
                     format_stamp(trajectory.back().stamp_ns));
}

nlohmann::json to_json(const ErrorStatistics& s, const std::string& unit) {
  return {{"rmse_" + unit, s.rmse}, {"mean_" + unit, s.mean}, {"median_" + unit, s.median},
          {"std_" + unit, s.std},   {"min_" + unit, s.min},   {"max_" + unit, s.max}};
}

nlohmann::json to_json(const std::optional<RpeResult>& rpe) {
  if (!rpe) return nullptr;
  return {{"pairs", rpe->translation_m.count},
          {"translation", to_json(rpe->translation_m, "m")},
          {"rotation", to_json(rpe->rotation_deg, "deg")}};
}

}  // namespace

Trajectory shifted(Trajectory trajectory, int64_t offset_ns) {
  for (StampedPose& pose : trajectory) pose.stamp_ns += offset_ns;
  return trajectory;
}

std::optional<AteResult> absolute_trajectory_error(const Trajectory& estimate, const Trajectory& truth,
                                                   const EvaluationOptions& options) {
  const auto pairs =
      pair_poses(shifted(estimate, options.offset_ns), truth, options.max_difference_ns, options.convention);
  std::vector<SE3> true_poses, poses;
  for (const StampPair& pair : pairs) {
    true_poses.push_back(truth[pair.a].T_world_camera);
    poses.push_back(estimate[pair.b].T_world_camera);
  }
  const auto S_truth_estimate = align_poses(true_poses, poses, options.alignment);
  if (!S_truth_estimate) return std::nullopt;

  AteResult result{{}, S_truth_estimate->T, S_truth_estimate->scale, {}};
  std::vector<double> errors_m;
  for (size_t i = 0; i < pairs.size(); ++i) {
    errors_m.push_back((S_truth_estimate->moved(poses[i]).translation - true_poses[i].translation).norm());
    result.poses.push_back({estimate[pairs[i].b].stamp_ns, errors_m.back()});
  }
  result.error_m = compute_statistics(errors_m);
  return result;
}

Coverage compute_coverage(const Trajectory& estimate, const Trajectory& truth, int64_t max_gap_ns,
                          int64_t max_difference_ns) {
  if (estimate.empty() || truth.empty()) return {};
  const int64_t begin_ns = truth.front().stamp_ns, end_ns = truth.back().stamp_ns;
  int64_t covered_ns = 0;
  for (size_t i = 1; i < estimate.size(); ++i) {
    const int64_t from_ns = estimate[i - 1].stamp_ns, to_ns = estimate[i].stamp_ns;
    if (to_ns - from_ns > max_gap_ns) continue;
    covered_ns += std::max<int64_t>(0, std::min(to_ns, end_ns) - std::max(from_ns, begin_ns));
  }
  const auto matched = associate_stamps(stamps_of(truth), stamps_of(estimate), max_difference_ns).size();
  const auto share = [](auto part, auto whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  return {share(covered_ns, end_ns - begin_ns), share(matched, estimate.size())};
}

std::optional<Evaluation> evaluate(const Trajectory& estimate, const Trajectory& truth,
                                   const EvaluationOptions& options) {
  auto ate = absolute_trajectory_error(estimate, truth, options);
  if (!ate) return std::nullopt;
  Trajectory scaled = estimate;
  for (StampedPose& pose : scaled) pose.T_world_camera.translation *= ate->scale;
  const auto rpe = [&](const RpeDelta& delta) { return relative_pose_error(scaled, truth, delta, options); };
  Evaluation evaluation{.ate = std::move(*ate),
                        .rpe_second = rpe({1, RpeDelta::Unit::kSeconds}),
                        .rpe_frame = rpe({1, RpeDelta::Unit::kFrames}),
                        .rpe = {},
                        .offset_ns = options.offset_ns,
                        .coverage = compute_coverage(shifted(estimate, options.offset_ns), truth, kMaxGapNs,
                                                     options.max_difference_ns)};
  for (const RpeDelta& delta : options.rpe) evaluation.rpe.push_back({delta, rpe(delta)});
  return evaluation;
}

std::string evaluation_failure(const Trajectory& estimate, const Trajectory& truth,
                               const EvaluationOptions& options) {
  return fmt::format("fewer than three poses have ground truth within {} s: the estimate {}, the truth {}",
                     to_seconds(options.max_difference_ns), span_text(shifted(estimate, options.offset_ns)),
                     span_text(truth));
}

nlohmann::json to_json(const Evaluation& evaluation) {
  nlohmann::json ate = to_json(evaluation.ate.error_m, "m");
  ate["pairs"] = evaluation.ate.error_m.count;
  nlohmann::json all = {
      {"ate", ate},
      {"rpe_1s", to_json(evaluation.rpe_second)},
      {"rpe_1frame", to_json(evaluation.rpe_frame)},
      {"coverage",
       {{"time", evaluation.coverage.time_fraction}, {"matched", evaluation.coverage.matched_fraction}}},
      {"scale", evaluation.ate.scale},
      {"offset_s", to_seconds(evaluation.offset_ns)}};
  for (const RpeOver& asked : evaluation.rpe) {
    all["rpe"].push_back({{"delta", to_string(asked.delta)}, {"error", to_json(asked.error)}});
  }
  return all;
}

}  // namespace kinloop
