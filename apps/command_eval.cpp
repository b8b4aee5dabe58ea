// kinloop eval: compares an estimated trajectory with ground truth.

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "apps/shared/commands.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/time.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

constexpr const char* kEvalFooter = R"(
Both files contain lines "timestamp tx ty tz qx qy qz qw". Figures are those of the TUM RGB-D benchmark's tools: poses
at most 0.02 s apart are associated, the estimate is rigidly aligned to the ground truth (no scale).
  ATE   distance between positions over the whole path          evaluate_ate.py
  RPE   error of the motion over 1 s and from frame to frame    evaluate_rpe.py --fixed_delta

Examples:
  kinloop run rgbd_dataset_freiburg1_room -o room
  kinloop eval room/trajectory.txt rgbd_dataset_freiburg1_room/groundtruth.txt)";

struct EvalArguments {
  std::filesystem::path estimate;
  std::filesystem::path truth;
  bool json = false;
};

void print_row(const char* name, const char* unit, const ErrorStatistics& s) {
  fmt::print("{:<20} {:<4} {:>10.6f} {:>10.6f} {:>10.6f} {:>10.6f} {:>10.6f} {:>10.6f} {:>7}\n", name, unit,
             s.rmse, s.mean, s.median, s.std, s.min, s.max, s.count);
}

void print_rpe(const char* interval, const std::optional<RpeResult>& rpe) {
  if (!rpe) return;
  print_row(fmt::format("RPE {} translation", interval).c_str(), "m", rpe->translation_m);
  print_row(fmt::format("RPE {} rotation", interval).c_str(), "deg", rpe->rotation_deg);
}

void print_table(const Evaluation& evaluation) {
  fmt::print("{:<25} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>7}\n", "", "rmse", "mean", "median", "std",
             "min", "max", "pairs");
  print_row("ATE", "m", evaluation.ate.error_m);
  print_rpe("1 s", evaluation.rpe_second);
  print_rpe("1 f", evaluation.rpe_frame);
  fmt::print(
      "\ncoverage   {:.1f} % of the ground truth's duration; {:.1f} % of the estimated poses have ground "
      "truth\n",
      100 * evaluation.coverage.time_fraction, 100 * evaluation.coverage.matched_fraction);
}

/// Reads a trajectory; refuses positions so far away that the figures would be noise.
Trajectory read_plausible(const std::filesystem::path& path) {
  constexpr double kFarthestM = 1e6;
  Trajectory trajectory = read_tum_trajectory(path);
  for (const auto& [stamp_ns, T] : trajectory) {
    if (T.translation.cwiseAbs().maxCoeff() <= kFarthestM) continue;
    throw InputError(
        fmt::format("{}: the position at {} s is over {} km from the origin; correct or delete the line",
                    path.string(), format_stamp(stamp_ns), kFarthestM / 1000));
  }
  return trajectory;
}

void run_eval(const EvalArguments& arguments) {
  const Trajectory estimate = read_plausible(arguments.estimate);
  const Trajectory truth = read_plausible(arguments.truth);
  const auto evaluation = evaluate(estimate, truth);
  if (!evaluation) {
    throw InputError(fmt::format("{}: {}; give the ground truth of the same recording",
                                 arguments.truth.string(), evaluation_failure(estimate, truth)));
  }
  if (arguments.json) {
    fmt::print("{}\n", json_text(to_json(*evaluation), 2));
  } else {
    print_table(*evaluation);
  }
}

}  // namespace

void add_eval_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("eval", "Compare a trajectory with ground truth: ATE, RPE, coverage");
  command->footer(kEvalFooter);
  auto arguments = std::make_shared<EvalArguments>();
  command->add_option("estimate", arguments->estimate, "the estimated trajectory, in TUM format")->required();
  command->add_option("groundtruth", arguments->truth, "the true trajectory, in TUM format")->required();
  command->add_flag("--json", arguments->json, "print the figures as JSON");
  command->callback([arguments] { run_eval(*arguments); });
}

}  // namespace kinloop
