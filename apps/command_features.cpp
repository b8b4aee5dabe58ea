// kinloop features: compares SIFT, SURF and ORB (Table 1, Figs. 3 and 4 of the paper: docs/lab/paper.md).

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/features/feature_comparison.hpp"
#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/features/extraction/surf.hpp"
#include "session/store/command_files.hpp"
#include "tools/feature_comparison/detectors.hpp"

namespace kinloop {
namespace {

double share(double part, double whole) {
  return whole > 0 ? part / whole : 0;
}

/// A column of the table: medians over the images or pairs of one seed, ratios over all its pairs together.
/// nullopt if it requires a ground truth that is missing.
struct Column {
  const char* key;    ///< in JSON
  const char* title;  ///< in the table
  int width;
  int digits;
  double unit;  ///< scale factor in the table
  const char* suffix;
  std::optional<double> (*of_seed)(const SeedMetrics& seed);
};

template <class Value>
double median_of_pairs(const SeedMetrics& seed, const Value& value) {
  std::vector<double> values;
  for (const PairMetrics& pair : seed.pairs) values.push_back(static_cast<double>(value(pair)));
  return median(values);
}

template <class Part, class Whole>
std::optional<double> share_of_pairs(const SeedMetrics& seed, const Part& part, const Whole& whole) {
  double visible = 0, parts = 0, wholes = 0;
  for (const PairMetrics& pair : seed.pairs) {
    visible += static_cast<double>(pair.visible);
    parts += static_cast<double>(part(pair));
    wholes += static_cast<double>(whole(pair));
  }
  return visible > 0 ? std::optional(share(parts, wholes)) : std::nullopt;
}

std::optional<double> median_error_px(const SeedMetrics& seed) {
  std::vector<double> errors_px;
  size_t visible = 0;
  for (const PairMetrics& pair : seed.pairs) {
    errors_px.insert(errors_px.end(), pair.errors_px.begin(), pair.errors_px.end());
    visible += pair.visible;
  }
  return visible > 0 ? std::optional(median(errors_px)) : std::nullopt;
}

using Figure = std::optional<double>;
using Pair = PairMetrics;

const std::array<Column, 8> kColumns = {{
    {"keypoints", "keypoints", 12, 0, 1, "",
     [](const SeedMetrics& s) -> Figure { return median(s.keypoints); }},
    {"milliseconds", "ms", 13, 2, 1, "",
     [](const SeedMetrics& s) -> Figure { return median(s.milliseconds); }},
    {"matches", "matches", 11, 0, 1, "",
     [](const SeedMetrics& s) -> Figure {
       return median_of_pairs(s, [](const Pair& p) { return p.matches; });
     }},
    {"screened", "screened", 11, 0, 1, "",
     [](const SeedMetrics& s) -> Figure {
       return median_of_pairs(s, [](const Pair& p) { return p.screened; });
     }},
    {"inliers", "inliers", 11, 0, 1, "",
     [](const SeedMetrics& s) -> Figure {
       return median_of_pairs(s, [](const Pair& p) { return p.inliers; });
     }},
    {"repeatability", "repeatability", 14, 1, 100, " %",
     [](const SeedMetrics& s) {
       return share_of_pairs(
           s, [](const Pair& p) { return p.repeated; }, [](const Pair& p) { return p.visible; });
     }},
    {"precision", "precision", 14, 1, 100, " %",
     [](const SeedMetrics& s) {
       return share_of_pairs(
           s, [](const Pair& p) { return p.correct; }, [](const Pair& p) { return p.checked; });
     }},
    {"error_px", "error px", 11, 2, 1, "", median_error_px},
}};

/// A figure over the seeds.
struct ColumnSpread {
  double median = 0, low = 0, high = 0;
};

std::optional<ColumnSpread> column_spread(const Column& column, const DetectorMetrics& detector) {
  std::vector<double> values;
  for (const SeedMetrics& seed : detector.seeds) {
    if (const auto value = column.of_seed(seed)) values.push_back(*value);
  }
  if (values.empty()) return std::nullopt;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return ColumnSpread{median(values), *low, *high};
}

std::string median_text(const Column& column, const ColumnSpread& spread) {
  return fmt::format("{:.{}f}{}", column.unit * spread.median, column.digits, column.suffix);
}

std::string range_text(const Column& column, const ColumnSpread& spread) {
  const auto number = [&](double value) {
    return fmt::format("{:.{}f}", column.unit * value, column.digits);
  };
  if (spread.low == spread.high) return "same";
  return fmt::format("{}-{}{}", number(spread.low), number(spread.high), column.suffix);
}

/// Returns a row of medians per detector, and below it the lowest and highest figure over the seeds.
std::string comparison_table(const std::vector<DetectorMetrics>& figures) {
  std::string table = fmt::format("{:<14}", "");
  for (const Column& column : kColumns) table += fmt::format("{:>{}}", column.title, column.width);
  for (const DetectorMetrics& detector : figures) {
    std::string medians = fmt::format("\n{:<14}", detector.name);
    std::string ranges = fmt::format("\n{:<14}", fmt::format("  {} seeds", detector.seeds.size()));
    for (const Column& column : kColumns) {
      const auto spread = column_spread(column, detector);
      medians += fmt::format("{:>{}}", spread ? median_text(column, *spread) : "-", column.width);
      ranges += fmt::format("{:>{}}", spread ? range_text(column, *spread) : "-", column.width);
    }
    table += medians + ranges;
  }
  return table + "\n";
}

/// Returns the medians, and as "ranges" the lowest and highest figure over the seeds.
nlohmann::json comparison_json(const std::vector<DetectorMetrics>& figures) {
  nlohmann::json list = nlohmann::json::array();
  for (const DetectorMetrics& detector : figures) {
    size_t images = 0, pairs = 0;
    for (const SeedMetrics& seed : detector.seeds) {
      images += seed.keypoints.size();
      pairs += seed.pairs.size();
    }
    nlohmann::json entry = {{"detector", detector.id},
                            {"name", detector.name},
                            {"images", images},
                            {"pairs", pairs},
                            {"seeds", detector.seeds.size()}};
    for (const Column& column : kColumns) {
      const auto spread = column_spread(column, detector);
      if (!spread) continue;
      entry[column.key] = spread->median;
      entry["ranges"][column.key] = {spread->low, spread->high};
    }
    list.push_back(entry);
  }
  return list;
}

constexpr const char* kFeaturesFooter = R"(
One image is compared with a copy rotated by 15 degrees, scaled by 0.85 and tilted; two images with each other; a
sequence with itself some frames later. Each figure is the median over the seeds, with the minimum and maximum
below it. Each seed draws different RANSAC samples, repeats the timing and, for a sequence, selects different pairs.
  ms             to detect and describe, CPU time of one thread
  matches        pairs of mutual nearest neighbours
  screened       of these, those with at most four times the smallest distance (ORB: at least 40 bits)
  inliers        of these, those within 3 px of one camera motion (P3P), one homography (one image) or one epipolar
                 geometry (two images)
  repeatability  fraction of the visible keypoints detected again within 3 px of the ground truth
  precision      fraction of screened matches within 3 px of the ground truth, and the median error

Examples:
  kinloop features rgbd_dataset_freiburg1_room --gap 20
  kinloop features before.png after.png -o pictures
  kinloop features photo.jpg -o pictures --set count=500)";

/// What the command reads, and the pictures that it writes.
CommandFiles command_files(const ComparisonArguments& arguments) {
  CommandFiles files{.inputs = {arguments.request.other_image, arguments.request.camera.camera}};
  add_sequence_input(files, arguments.request.input, arguments.request.chosen);
  NamedResults pictures{{"-o", arguments.pictures}, {}};
  for (const char* detector : {"sift", "surf", "orb-opencv", "orb"}) {
    for (const char* step : {"all", "screened", "inliers"})
      pictures.names.push_back(fmt::format("{}_{}.png", detector, step));
  }
  files.results = {pictures};
  return files;
}

void run_features(ComparisonArguments arguments, const std::vector<std::string>& assignments, bool as_json) {
  arguments.features = with_assignments(FeatureOptions{}, assignments);
  if (!arguments.pictures.empty()) {
    require_outputs(command_files(arguments));
    require_writable_folder(arguments.pictures);
  }
  const auto figures = compare_detectors(arguments);
  if (as_json) {
    fmt::print("{}\n", json_text(comparison_json(figures), 2));
    return;
  }
  fmt::print("{}", comparison_table(figures));
  if (!surf_available()) fmt::print("SURF is not available: kinloop was built without dlib\n");
}

}  // namespace

void add_features_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("features", "Compare SIFT, SURF and ORB: count, time, matches, inliers");
  command->footer(kFeaturesFooter);
  auto arguments = std::make_shared<ComparisonArguments>();
  auto assignments = std::make_shared<std::vector<std::string>>();
  auto json = std::make_shared<bool>(false);
  auto& request = arguments->request;
  command->add_option("input", request.input, "an image, a folder in TUM layout, or sim:room")->required();
  command->add_option("second", request.other_image, "a second image to compare with the first");
  add_sequence_option(*command, request.chosen);
  add_camera_options(*command, request.camera);
  command->add_option("-o,--output", arguments->pictures,
                      "folder for pictures of the matches of one pair: all, screened, inliers");
  command->add_option("--pairs", request.pairs, "number of frame pairs per seed, spread over the sequence")
      ->check(whole_number(1, 100000))
      ->capture_default_str();
  command->add_option("--gap", request.gap, "frames between the two images of a pair")
      ->check(whole_number(1, 100000))
      ->capture_default_str();
  command
      ->add_option(
          "--seeds", request.seeds,
          "number of random seeds for pairs and samples; each figure is given with its range over the seeds")
      ->check(whole_number(1, 1000))
      ->capture_default_str();
  command->add_option("--detectors", arguments->wanted, "run only these: sift,surf,orb-opencv,orb")
      ->delimiter(',');
  add_set_option(*command, *assignments, "set a feature option, e.g. count=500");
  command->add_flag("--json", *json, "print the figures as JSON");
  command->callback([arguments, assignments, json] { run_features(*arguments, *assignments, *json); });
}

}  // namespace kinloop
