// kinloop features: compares SIFT, SURF and ORB (Table 1 and Figs. 3 and 4 of the founding paper).

#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "apps/features/feature_comparison.hpp"
#include "apps/features/feature_table.hpp"
#include "apps/shared/commands.hpp"
#include "apps/shared/common_options.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/features/surf.hpp"
#include "tools/feature_comparison/detectors.hpp"

namespace kinloop {
namespace {

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

void run_features(ComparisonArguments arguments, const std::vector<std::string>& assignments, bool as_json) {
  arguments.features = with_assignments(FeatureOptions{}, assignments);
  if (!arguments.pictures.empty()) require_writable_folder(arguments.pictures);
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
  command->add_option("--camera", request.camera, "camera.yaml or preset, as for kinloop run");
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
