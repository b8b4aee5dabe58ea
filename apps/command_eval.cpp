// kinloop eval: compares estimated trajectories with ground truth.

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/time.hpp"
#include "session/store/command_files.hpp"
#include "session/store/named_trajectory.hpp"
#include "tools/evaluation/compare.hpp"
#include "tools/evaluation/report/evaluation_plot.hpp"
#include "tools/evaluation/report/evaluation_table.hpp"

namespace kinloop {
namespace {

constexpr const char* kEvalFooter = R"(
Trajectories are files in TUM format (lines "timestamp tx ty tz qx qy qz qw"), EuRoC or KITTI format, or tables with
named columns; or folders: of a run, or of a recording with ground truth. Figures are those of the TUM RGB-D
benchmark's tools: poses at most 0.02 s apart are associated, the estimate is rigidly aligned to the ground truth (no
scale). See docs/evaluation.md.
  ATE   distance between positions over the whole path          evaluate_ate.py
  RPE   error of the motion over 1 s and from frame to frame    evaluate_rpe.py --fixed_delta

Examples:
  kinloop run rgbd_dataset_freiburg1_room -o room
  kinloop eval room/trajectory.txt rgbd_dataset_freiburg1_room/groundtruth.txt
  kinloop eval room other.txt rgbd_dataset_freiburg1_room --rpe 1m --plot errors.svg)";

struct EvalArguments {
  std::vector<std::filesystem::path> trajectories;  ///< estimates, then the ground truth
  std::string alignment = "se3";
  std::string convention = "tum";
  std::string format = "text";
  std::string offset = "0";
  double max_difference_s = to_seconds(kMaxAssociationNs);
  std::vector<std::string> rpe;
  std::filesystem::path plot;
  bool json = false;
};

constexpr const char* kEstimateOffset = "estimate";

/// The command line has been checked.
EvaluationOptions options_of(const EvalArguments& arguments) {
  EvaluationOptions options{.alignment = *value_named<Alignment>(arguments.alignment),
                            .max_difference_ns = to_ns(arguments.max_difference_s),
                            .convention = *value_named<Convention>(arguments.convention)};
  if (arguments.offset != kEstimateOffset) options.offset_ns = *parse_stamp_ns(arguments.offset);
  for (const std::string& delta : arguments.rpe) options.rpe.push_back(*parse_rpe_delta(delta));
  return options;
}

/// Throws UsageError if the only path is no folder, which could hold both trajectories.
void require_truth(const std::vector<std::filesystem::path>& trajectories) {
  std::error_code unknown;
  if (trajectories.size() > 1 || std::filesystem::is_directory(trajectories.front(), unknown)) return;
  throw UsageError(fmt::format("eval {}: the ground truth is missing; give it after the estimates",
                               trajectories.front().string()));
}

void run_eval(const EvalArguments& arguments) {
  require_truth(arguments.trajectories);
  auto estimates = arguments.trajectories;
  const std::filesystem::path truth_path = estimates.back();
  if (estimates.size() > 1) estimates.pop_back();  // else a run that has its ground truth
  CommandFiles files{.outputs = {{"--plot", arguments.plot}}};
  for (const auto& path : arguments.trajectories) {
    add_input(files, path);
    for (const auto& file : trajectories_in(path)) files.inputs.push_back(file);
  }
  require_outputs(files);

  const NamedTrajectory truth{truth_path.string(), open_ground_truth(truth_path)};
  std::vector<NamedEvaluation> evaluations;
  std::vector<PlottedEstimate> plotted;
  Trajectory plotted_truth;
  for (const auto& path : estimates) {
    Comparison found = compare({{path.string(), open_estimate(path)},
                                truth,
                                options_of(arguments),
                                arguments.offset == kEstimateOffset});
    for (const std::string& note : found.notes) log::warn("{}", note);
    evaluations.push_back({path.string(), found.evaluation});
    plotted.push_back({path.string(), std::move(found.estimate), std::move(found.evaluation)});
    plotted_truth = std::move(found.truth);
  }
  const auto format = arguments.json ? TableFormat::kJson : *value_named<TableFormat>(arguments.format);
  fmt::print("{}", evaluation_table(evaluations, format));
  if (!arguments.plot.empty()) write_file(arguments.plot, evaluation_plot(plotted, plotted_truth));
}

std::string check_offset(const std::string& text) {
  if (text == kEstimateOffset || parse_stamp_ns(text)) return {};
  return fmt::format("'{}' is neither seconds nor 'estimate'", text);
}

std::string check_delta(const std::string& text) {
  if (parse_rpe_delta(text)) return {};
  return rpe_delta_error(text);
}

void add_comparison_options(CLI::App& command, EvalArguments& arguments) {
  constexpr double kMostDifferenceS = 10;
  command
      .add_option("--align", arguments.alignment,
                  "motion that aligns the estimate: se3; sim3: and a scale; yaw: about the vertical z axis\n"
                  "of the ground truth, and a translation; none")
      ->check(one_of(names_of<Alignment>()))
      ->capture_default_str();
  command
      .add_option(
          "--offset", arguments.offset,
          "seconds to add to the time stamps of the estimate; estimate: find them by comparing motion")
      ->check(CLI::Validator(check_offset, "SECONDS"))
      ->capture_default_str();
  command
      .add_option("--max-difference", arguments.max_difference_s,
                  "largest difference between the time stamps of associated poses, s")
      ->check(kinloop::number(0, kMostDifferenceS))
      ->capture_default_str();
  command
      .add_option("--rpe", arguments.rpe,
                  "a further interval of the RPE: seconds (5s), frames (10f) or metres of the path (0.5m);\n"
                  "may be repeated")
      ->allow_extra_args(false)
      ->option_text("DELTA")
      ->check(CLI::Validator(check_delta, "DELTA"));
  command
      .add_option("--convention", arguments.convention,
                  "whose figures to give: tum, or evo: those of evo_ape and evo_rpe --all_pairs")
      ->check(one_of(names_of<Convention>()))
      ->capture_default_str();
}

}  // namespace

void add_eval_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "eval", "Compare trajectories with ground truth: ATE, RPE, coverage, tables and plots");
  command->footer(kEvalFooter);
  auto arguments = std::make_shared<EvalArguments>();
  command
      ->add_option(
          "TRAJECTORIES", arguments->trajectories,
          "estimated trajectories, then the true one: files or folders; the folder of a run alone is\n"
          "compared with the ground truth that it has")
      ->option_text("ESTIMATE... GROUNDTRUTH")
      ->required();
  add_comparison_options(*command, *arguments);
  CLI::Option* format = command->add_option("--format", arguments->format, "text, csv, json or latex")
                            ->check(one_of(names_of<TableFormat>()))
                            ->capture_default_str();
  command->add_flag("--json", arguments->json, "print the figures as JSON")->excludes(format);
  command->add_option("--plot", arguments->plot, "SVG image of the paths and their errors to write")
      ->option_text("FILE.svg");
  command->callback([arguments] { run_eval(*arguments); });
}

}  // namespace kinloop
