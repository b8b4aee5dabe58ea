#include "apps/features/feature_comparison.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "session/source/open_frame_source.hpp"
#include "tools/feature_comparison/detectors.hpp"
#include "tools/feature_comparison/draw_matches.hpp"

namespace kinloop {

namespace {

constexpr int64_t kMaxTruthGapNs =
    20'000'000;  // between a frame and the ground truth poses around it: 0.02 s

/// Any undistorted camera will do for image files, since pixels stay unchanged.
PinholeCamera camera_for(const cv::Mat& gray) {
  PinholeCamera camera;
  camera.width = gray.cols;
  camera.height = gray.rows;
  camera.fx = camera.fy = gray.cols;
  return camera;
}

/// Pairs an image with its view from slightly farther away, turned by 15 degrees.
ImagePair pair_of_image(const std::filesystem::path& path) {
  constexpr double kTurnDeg = 15, kScale = 0.85, kTilt = 2e-4;
  ImagePair pair;
  pair.a.gray = read_color_image(path).gray();
  const int width = pair.a.gray.cols, height = pair.a.gray.rows;
  const cv::Mat turn = cv::getRotationMatrix2D(
      {static_cast<float>(width) / 2, static_cast<float>(height) / 2}, kTurnDeg, kScale);
  Eigen::Matrix3d H;
  H << turn.at<double>(0, 0), turn.at<double>(0, 1), turn.at<double>(0, 2), turn.at<double>(1, 0),
      turn.at<double>(1, 1), turn.at<double>(1, 2), kTilt, 0, 1;
  const cv::Matx33d H_cv(H(0, 0), H(0, 1), H(0, 2), H(1, 0), H(1, 1), H(1, 2), H(2, 0), H(2, 1), H(2, 2));
  cv::warpPerspective(pair.a.gray, pair.b.gray, H_cv, pair.a.gray.size());
  pair.H_b_a = H;
  return pair;
}

ImagePair pair_of_images(const std::filesystem::path& first, const std::filesystem::path& second) {
  ImagePair pair;
  pair.a.gray = read_color_image(first).gray();
  pair.b.gray = read_color_image(second).gray();
  return pair;
}

/// Start frames of the pairs, with the seeds that chose them; one in each of `pairs` equal parts of the
/// sequence.
std::map<size_t, std::vector<size_t>> choose_starts(const PairsRequest& request, size_t frames) {
  const size_t possible = frames - request.gap;
  const size_t count = std::min(request.pairs, possible);
  std::map<size_t, std::vector<size_t>> seeds_of;
  for (size_t seed = 0; seed < request.seeds; ++seed) {
    Random random(hash(seed, 1));
    for (size_t k = 0; k < count; ++k) {
      const double part = static_cast<double>(possible) / static_cast<double>(count);
      const auto start = static_cast<size_t>(part * (static_cast<double>(k) + random.uniform()));
      seeds_of[std::min(start, possible - 1)].push_back(seed);
    }
  }
  return seeds_of;
}

PosedPicture view_of(const Frame& frame, const Trajectory& truth) {
  return {frame.color.gray(), frame.depth_m, pose_at(truth, frame.stamp_ns, kMaxTruthGapNs)};
}

/// Reads the sequence once, keeping only the frames of unfinished pairs.
void visit_frames(FrameSource& source, const std::map<size_t, std::vector<size_t>>& starts, size_t gap,
                  const std::function<void(const ImagePair&)>& visit) {
  const size_t last = starts.rbegin()->first + gap;
  // The middle one of the first seed's pairs.
  std::vector<size_t> of_first;
  for (const auto& [start, seeds] : starts) {
    if (seeds.front() == 0) of_first.push_back(start);
  }
  const size_t shown = of_first[of_first.size() / 2];
  std::map<size_t, PosedPicture> begun;
  for (size_t i = 0; i <= last; ++i) {
    const auto frame = source.next();
    if (!frame) break;
    const auto begins = starts.find(i), ends = i < gap ? starts.end() : starts.find(i - gap);
    if (begins == starts.end() && ends == starts.end()) continue;
    const PosedPicture view = view_of(*frame, source.info().ground_truth);
    if (begins != starts.end()) begun[i] = view;
    if (ends == starts.end()) continue;
    for (const size_t seed : ends->second)
      visit({begun.at(i - gap), view, std::nullopt, seed, i - gap == shown && seed == 0});
    begun.erase(i - gap);
  }
}

}  // namespace

OpenPairs open_pairs(const PairsRequest& request) {
  OpenPairs pairs{request, {}, {}, {}};
  if (!request.other_image.empty()) {
    pairs.images = pair_of_images(request.input, request.other_image);
  } else if (std::filesystem::is_regular_file(request.input)) {
    pairs.images = pair_of_image(request.input);
  }
  if (pairs.images) {
    pairs.camera = camera_for(pairs.images->a.gray);
    return pairs;
  }
  SourceRequest sequence;
  sequence.sequence = request.input;
  sequence.chosen = request.chosen;
  set_camera(sequence, request.camera);
  pairs.source = open_frame_source(sequence);
  pairs.camera = pairs.source->camera().color;
  const size_t frames = pairs.source->info().frames;
  if (frames <= request.gap)
    throw UsageError(fmt::format("--gap {}: '{}' has only {} frames", request.gap, request.input, frames));
  return pairs;
}

void for_each_pair(OpenPairs& pairs, const std::function<void(const ImagePair&)>& visit) {
  const PairsRequest& request = pairs.request;
  if (!pairs.images) {
    visit_frames(*pairs.source, choose_starts(request, pairs.source->info().frames), request.gap, visit);
    return;
  }
  for (size_t seed = 0; seed < request.seeds; ++seed) {
    pairs.images->seed = seed;
    pairs.images->shown = seed == 0;
    visit(*pairs.images);
  }
}

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
