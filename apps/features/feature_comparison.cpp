#include "apps/features/feature_comparison.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/sensor/images/image_file.hpp"
#include "tools/feature_comparison/detectors.hpp"
#include "tools/feature_comparison/draw_matches.hpp"

namespace kinloop {
namespace {

GroundTruthPixels ground_truth_pixels(const ImagePair& pair, const Features& a, const PinholeCamera& camera) {
  if (pair.H_b_a) return ground_truth_pixels_from_homography(a, pair.b.gray.size(), *pair.H_b_a);
  if (!pair.a.T_world_camera || !pair.b.T_world_camera) return {};
  const SE3 T_b_a = pair.b.T_world_camera->inverse() * *pair.a.T_world_camera;
  return ground_truth_pixels_from_motion(a, pair.a.depth_m, pair.b.depth_m, camera, T_b_a);
}

/// Chooses the geometric model by what is known of the pair.
std::vector<DescriptorMatch> ransac_inliers(const ImagePair& pair, const MatchedFeatures& matched,
                                            const PinholeCamera& camera) {
  const uint64_t seed = hash(pair.seed, 2);
  if (pair.H_b_a) return homography_inliers(matched, seed);
  if (pair.a.depth_m.empty()) return epipolar_inliers(matched, seed);
  return motion_inliers(matched, pair.a.depth_m, camera, seed);
}

/// Keypoints of both images of a pair, with the CPU time of detection.
struct DetectedPair {
  Features a, b;
  double a_ms = 0, b_ms = 0;
};

DetectedPair detect(const Detector& detector, const ImagePair& pair) {
  DetectedPair found;
  const Stopwatch watch_a;
  found.a = detector.detect(pair.a.gray);
  found.a_ms = 1e3 * watch_a.cpu_s();
  const Stopwatch watch_b;
  found.b = detector.detect(pair.b.gray);
  found.b_ms = 1e3 * watch_b.cpu_s();
  return found;
}

/// The matches after each step.
struct MatchSteps {
  std::vector<DescriptorMatch> all, screened, inliers;
};

/// Writes a picture of the matches of each step, with the figures below.
void write_pictures(const std::filesystem::path& folder, const Detector& detector, const ImagePair& pair,
                    const DetectedPair& found, const MatchSteps& steps) {
  const std::string features = fmt::format("{}: {} and {} keypoints, {:.1f} and {:.1f} ms", detector.name,
                                           found.a.size(), found.b.size(), found.a_ms, found.b_ms);
  const std::string matches = fmt::format("{} matches, {} of them screened, {} of these RANSAC inliers",
                                          steps.all.size(), steps.screened.size(), steps.inliers.size());
  const auto write = [&](const char* step, const std::vector<DescriptorMatch>& shown) {
    const cv::Mat drawn = draw_matches(pair.a.gray, found.a, pair.b.gray, found.b, shown);
    write_png(folder / fmt::format("{}_{}.png", detector.id, step),
              add_caption(drawn, {features, fmt::format("{}. Shown: {}", matches, step)}));
  };
  write("all", steps.all);
  write("screened", steps.screened);
  write("inliers", steps.inliers);
}

void measure(const Detector& detector, const ImagePair& pair, const PinholeCamera& camera,
             const std::filesystem::path& pictures, SeedMetrics& figures) {
  const DetectedPair found = detect(detector, pair);
  const auto& [a, b, a_ms, b_ms] = found;
  for (const double ms : {a_ms, b_ms}) figures.milliseconds.push_back(ms);
  for (const size_t count : {a.size(), b.size()}) figures.keypoints.push_back(static_cast<double>(count));
  MatchSteps steps;
  steps.all = match_descriptors(a, b);
  steps.screened = filter_by_distance(steps.all, a.descriptors.type() == CV_8UC1);
  steps.inliers = ransac_inliers(pair, {a, b, steps.screened}, camera);
  figures.pairs.push_back(evaluate_pair(b, steps.all, steps.screened, ground_truth_pixels(pair, a, camera)));
  figures.pairs.back().inliers = steps.inliers.size();
  if (!pictures.empty() && pair.shown) write_pictures(pictures, detector, pair, found, steps);
}

std::vector<Detector> wanted_detectors(const ComparisonArguments& arguments, const PinholeCamera& camera) {
  std::vector<Detector> detectors = make_detectors(arguments.features, camera);
  const auto& wanted = arguments.wanted;
  if (wanted.empty()) return detectors;
  std::string known;
  for (const Detector& detector : detectors) known += " " + detector.id;
  std::erase_if(detectors, [&](const Detector& detector) {
    return std::find(wanted.begin(), wanted.end(), detector.id) == wanted.end();
  });
  if (detectors.size() < wanted.size())
    throw UsageError(fmt::format("--detectors: available in this build:{}", known));
  return detectors;
}

}  // namespace

std::vector<DetectorMetrics> compare_detectors(const ComparisonArguments& arguments) {
  OpenPairs pairs = open_pairs(arguments.request);
  const auto detectors = wanted_detectors(arguments, pairs.camera);
  std::vector<DetectorMetrics> figures;
  for (const Detector& detector : detectors)
    figures.push_back({detector.name, detector.id, std::vector<SeedMetrics>(arguments.request.seeds)});
  for_each_pair(pairs, [&](const ImagePair& pair) {
    for (size_t i = 0; i < detectors.size(); ++i)
      measure(detectors[i], pair, pairs.camera, arguments.pictures, figures[i].seeds.at(pair.seed));
  });
  return figures;
}

}  // namespace kinloop
