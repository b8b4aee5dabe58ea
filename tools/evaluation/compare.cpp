#include "tools/evaluation/compare.hpp"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"
#include "tools/evaluation/recognition.hpp"

namespace kinloop {
namespace {

/// Refuses positions so far away that the figures would be noise.
void require_plausible_positions(const NamedTrajectory& named) {
  constexpr double kFarthestM = 1e6;
  for (const auto& [stamp_ns, T] : named.file.poses) {
    if (T.translation.cwiseAbs().maxCoeff() <= kFarthestM) continue;
    throw InputError(
        fmt::format("{}: the position at {} s is over {} km from the origin; correct or delete the line",
                    named.name, format_stamp(stamp_ns), kFarthestM / 1000));
  }
}

/// Refuses poses of which more than 1 % share their time with another.
void require_distinct_stamps(const NamedTrajectory& named) {
  const Trajectory& poses = named.file.poses;
  size_t repeated = 0;
  for (size_t i = 1; i < poses.size(); ++i) repeated += poses[i].stamp_ns == poses[i - 1].stamp_ns ? 1 : 0;
  if (100 * repeated <= poses.size()) return;
  throw InputError(
      fmt::format("{}: {} of {} time stamps repeat; give each trajectory by itself, with exact stamps",
                  named.name, repeated, poses.size()));
}

/// Gives poses without stamps those of the others, pose by pose.
void match_numbers(NamedTrajectory& without, const NamedTrajectory& other, std::vector<std::string>& notes) {
  Trajectory& poses = without.file.poses;
  if (poses.size() != other.file.poses.size()) {
    throw InputError(
        fmt::format("{}: has no time stamps, and another number of poses ({}) than {} ({}); put times.txt "
                    "with a time for each pose beside it, or use TUM format",
                    without.name, poses.size(), other.name, other.file.poses.size()));
  }
  for (size_t i = 0; i < poses.size(); ++i) poses[i].stamp_ns = other.file.poses[i].stamp_ns;
  notes.push_back(fmt::format("{}: has no time stamps; compared pose by pose", without.name));
}

/// Takes quaternions as w x y z where that makes the motions agree.
void set_quaternion_orders(ComparisonRequest& request, std::vector<std::string>& notes) {
  const WhichTrajectory found = find_w_first(
      request.estimate.file.poses, request.truth.file.poses,
      {!request.estimate.file.knows_quaternion_order, !request.truth.file.knows_quaternion_order},
      request.options);
  const auto swap = [&](NamedTrajectory& named) {
    named.file.poses = with_w_first(std::move(named.file.poses));
    notes.push_back(fmt::format(
        "{}: quaternions are taken as qw qx qy qz, with which its motion is that of the other", named.name));
  };
  if (found.estimate) swap(request.estimate);
  if (found.truth) swap(request.truth);
}

std::string seconds_text(int64_t duration_ns) {
  return fmt::format("{:.3f}", to_seconds(duration_ns));
}

[[noreturn]] void throw_no_figures(const ComparisonRequest& request) {
  const Trajectory &estimate = request.estimate.file.poses, &truth = request.truth.file.poses;
  std::string remedy = "give the ground truth of the same recording";
  if (const auto offset_ns = estimate_clock_offset(estimate, truth))
    remedy += fmt::format(", or --offset {}: the motion is the same then", seconds_text(*offset_ns));
  throw InputError(fmt::format("{}: {}; {}", request.truth.name,
                               evaluation_failure(estimate, truth, request.options), remedy));
}

void set_estimated_offset(ComparisonRequest& request, std::vector<std::string>& notes) {
  const auto offset_ns = estimate_clock_offset(request.estimate.file.poses, request.truth.file.poses);
  if (!offset_ns) {
    throw InputError(
        fmt::format("{}: the clock offset from {} cannot be estimated: the motion does not tell, or is not "
                    "the same; give it by --offset SECONDS",
                    request.estimate.name, request.truth.name));
  }
  request.options.offset_ns = *offset_ns;
  notes.push_back(
      fmt::format("{}: {} s are added to its time stamps", request.estimate.name, seconds_text(*offset_ns)));
}

/// Says so if at another clock offset, which the motion tells, the error is far smaller.
void check_clock(const ComparisonRequest& request, const Evaluation& evaluation,
                 std::vector<std::string>& notes) {
  constexpr double kFarSmaller = 0.5;
  const Trajectory &estimate = request.estimate.file.poses, &truth = request.truth.file.poses;
  const auto offset_ns = estimate_clock_offset(estimate, truth);
  if (!offset_ns || std::abs(*offset_ns - request.options.offset_ns) < request.options.max_difference_ns)
    return;
  EvaluationOptions at_offset = request.options;
  at_offset.offset_ns = *offset_ns;
  const auto ate = absolute_trajectory_error(estimate, truth, at_offset);
  if (!ate || ate->error_m.rmse > kFarSmaller * evaluation.ate.error_m.rmse) return;
  notes.push_back(fmt::format(
      "{}: its clock seems to be off: with --offset {} the ATE is {:.4f} m instead of {:.4f} m",
      request.estimate.name, seconds_text(*offset_ns), ate->error_m.rmse, evaluation.ate.error_m.rmse));
}

Trajectory inverses(Trajectory trajectory) {
  for (StampedPose& pose : trajectory) pose.T_world_camera = pose.T_world_camera.inverse();
  return trajectory;
}

/// Says so if the poses of one trajectory are those of the world in the camera, as COLMAP and extrinsic
/// matrices have them: inverted they fit far better.
void check_direction(const ComparisonRequest& request, const Evaluation& evaluation,
                     std::vector<std::string>& notes) {
  constexpr double kFarSmaller = 0.3;  // of the error; by chance, the inverse of a bad estimate may halve it
  const Trajectory &estimate = request.estimate.file.poses, &truth = request.truth.file.poses;
  double least_m = kFarSmaller * evaluation.ate.error_m.rmse;
  const NamedTrajectory* inverted = nullptr;
  const auto try_inverse = [&](const NamedTrajectory& named, const std::optional<AteResult>& ate) {
    if (!ate || ate->error_m.rmse > least_m) return;
    least_m = ate->error_m.rmse;
    inverted = &named;
  };
  try_inverse(request.estimate, absolute_trajectory_error(inverses(estimate), truth, request.options));
  try_inverse(request.truth, absolute_trajectory_error(estimate, inverses(truth), request.options));
  if (inverted == nullptr) return;
  notes.push_back(fmt::format(
      "{}: its poses seem to be world to camera: inverted they give an ATE of {:.4f} m instead of "
      "{:.4f} m; invert each pose, the figures here mean nothing",
      inverted->name, least_m, evaluation.ate.error_m.rmse));
}

void note_missing_rpe(const ComparisonRequest& request, const Evaluation& evaluation,
                      std::vector<std::string>& notes) {
  const auto note = [&](const RpeDelta& delta, const std::optional<RpeResult>& error) {
    if (error) return;
    notes.push_back(fmt::format("{}: no RPE over {}: {}", request.estimate.name, to_string(delta),
                                rpe_failure(request.estimate.file.poses, delta)));
  };
  note({1, RpeDelta::Unit::kSeconds}, evaluation.rpe_second);
  note({1, RpeDelta::Unit::kFrames}, evaluation.rpe_frame);
  for (const RpeOver& asked : evaluation.rpe) note(asked.delta, asked.error);
}

/// Numbered poses have no time: their drift per second is unknown.
void drop_rpe_over_seconds(Evaluation& evaluation, std::vector<std::string>& notes) {
  evaluation.rpe_second.reset();
  for (RpeOver& asked : evaluation.rpe) {
    if (asked.delta.unit == RpeDelta::Unit::kSeconds) asked.error.reset();
  }
  notes.emplace_back("neither trajectory has time stamps: no RPE over seconds");
}

}  // namespace

Comparison compare(ComparisonRequest request) {
  NamedTrajectory &estimate = request.estimate, &truth = request.truth;
  std::vector<std::string> notes;
  for (const NamedTrajectory* named : {&estimate, &truth}) {
    require_plausible_positions(*named);
    require_distinct_stamps(*named);
    for (const std::string& note : named->file.notes)
      notes.push_back(fmt::format("{}: {}", named->name, note));
  }
  const bool has_time = estimate.file.has_stamps || truth.file.has_stamps;
  if (!estimate.file.has_stamps) {
    match_numbers(estimate, truth, notes);
  } else if (!truth.file.has_stamps) {
    match_numbers(truth, estimate, notes);
  }
  if (request.estimate_offset) set_estimated_offset(request, notes);
  set_quaternion_orders(request, notes);
  auto evaluation = evaluate(estimate.file.poses, truth.file.poses, request.options);
  if (!evaluation) throw_no_figures(request);
  check_direction(request, *evaluation, notes);
  if (has_time) {
    check_clock(request, *evaluation, notes);
    note_missing_rpe(request, *evaluation, notes);
  } else {
    drop_rpe_over_seconds(*evaluation, notes);
  }
  return {std::move(*evaluation), shifted(std::move(estimate.file.poses), request.options.offset_ns),
          std::move(truth.file.poses), std::move(notes)};
}

}  // namespace kinloop
