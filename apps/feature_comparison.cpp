#include "apps/feature_comparison.hpp"

#include <algorithm>
#include <map>
#include <memory>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/open_source.hpp"
#include "kinloop/base/errors.hpp"
#include "kinloop/base/quantile.hpp"
#include "kinloop/base/stopwatch.hpp"
#include "kinloop/base/text_file.hpp"
#include "kinloop/compare/detectors.hpp"
#include "kinloop/compare/match_picture.hpp"
#include "kinloop/sensor/image_file.hpp"

namespace kinloop {
namespace {

constexpr int64_t kMaxTruthGapNs = 20'000'000;  // between a frame and the true poses around it: 0.02 s

struct View {
  cv::Mat gray, depth_m;  ///< no depth for a single image
  std::optional<SE3> T_world_camera;
};

/// Two images of the same place, and what is known of where they were taken from.
struct ImagePair {
  View a, b;
  std::optional<Eigen::Matrix3d> H_b_a;  ///< of an image and its picture
};

struct Pairs {
  PinholeCamera camera;
  std::vector<ImagePair> pairs;
};

cv::Mat to_gray(const cv::Mat& color) {
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

/// An image and what a camera would see of it from a little further away, turned by 15 degrees.
Pairs pair_of_image(const std::filesystem::path& path) {
  constexpr double kTurnDeg = 15, kScale = 0.85, kTilt = 2e-4;
  Pairs result;
  ImagePair pair;
  pair.a.gray = to_gray(read_color_image(path));
  const int width = pair.a.gray.cols, height = pair.a.gray.rows;
  const cv::Mat turn = cv::getRotationMatrix2D(
      {static_cast<float>(width) / 2, static_cast<float>(height) / 2}, kTurnDeg, kScale);
  Eigen::Matrix3d H;
  H << turn.at<double>(0, 0), turn.at<double>(0, 1), turn.at<double>(0, 2), turn.at<double>(1, 0),
      turn.at<double>(1, 1), turn.at<double>(1, 2), kTilt, 0, 1;
  const cv::Matx33d H_cv(H(0, 0), H(0, 1), H(0, 2), H(1, 0), H(1, 1), H(1, 2), H(2, 0), H(2, 1), H(2, 2));
  cv::warpPerspective(pair.a.gray, pair.b.gray, H_cv, pair.a.gray.size());
  pair.H_b_a = H;
  // Any camera without distortion will do: pixels stay what they are.
  result.camera.width = width;
  result.camera.height = height;
  result.camera.fx = result.camera.fy = width;
  result.pairs.push_back(pair);
  return result;
}

View view_of(const RgbdFrame& frame, const Trajectory& truth) {
  return {to_gray(frame.color), frame.depth_m, pose_at(truth, frame.stamp_ns, kMaxTruthGapNs)};
}

Pairs pairs_of_sequence(const ComparisonArguments& arguments) {
  const auto camera = arguments.camera.empty() ? std::nullopt : std::optional(arguments.camera);
  SourceRequest request;
  request.sequence = arguments.input;
  request.camera = camera;
  const auto source = open_source(request);
  const size_t frames = source->info().frames;
  if (frames <= arguments.gap) {
    throw UsageError(
        fmt::format("--gap {}: '{}' has {} frames only", arguments.gap, arguments.input, frames));
  }
  const size_t count = std::min(arguments.pairs, frames - arguments.gap);
  std::map<size_t, View> wanted;
  std::vector<size_t> starts;
  for (size_t k = 0; k < count; ++k) {
    starts.push_back(k * (frames - arguments.gap) / count);
    wanted[starts.back()] = wanted[starts.back() + arguments.gap] = {};
  }
  for (size_t i = 0; i <= wanted.rbegin()->first; ++i) {
    const auto frame = source->next();
    if (!frame) break;
    const auto found = wanted.find(i);
    if (found != wanted.end()) found->second = view_of(*frame, source->info().ground_truth);
  }
  Pairs result;
  result.camera = source->camera().color;
  for (const size_t start : starts) {
    const View &a = wanted[start], &b = wanted[start + arguments.gap];
    if (!a.gray.empty() && !b.gray.empty()) result.pairs.push_back({a, b, std::nullopt});
  }
  return result;
}

TrueSights true_sights(const ImagePair& pair, const Features& a, const PinholeCamera& camera) {
  if (pair.H_b_a) return sights_by_homography(a, pair.b.gray.size(), *pair.H_b_a);
  if (!pair.a.T_world_camera || !pair.b.T_world_camera) return {};
  const SE3 T_b_a = pair.b.T_world_camera->inverse() * *pair.a.T_world_camera;
  return sights_by_motion(a, pair.a.depth_m, pair.b.depth_m, camera, T_b_a);
}

void write_picture(const std::filesystem::path& path, const cv::Mat& picture) {
  std::vector<uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  write_file(path, std::string(bytes.begin(), bytes.end()));
}

Features detect_timed(const Detector& detector, const cv::Mat& gray, DetectorFigures& figures) {
  const Stopwatch watch;
  Features features = detector.detect(gray);
  figures.milliseconds.push_back(1e3 * watch.cpu_s());
  figures.key_points.push_back(static_cast<double>(features.size()));
  return features;
}

DetectorFigures measure(const Detector& detector, const Pairs& pairs, const std::filesystem::path& pictures) {
  DetectorFigures figures{detector.name, detector.id, {}, {}, {}};
  for (size_t i = 0; i < pairs.pairs.size(); ++i) {
    const ImagePair& pair = pairs.pairs[i];
    const Features a = detect_timed(detector, pair.a.gray, figures);
    const Features b = detect_timed(detector, pair.b.gray, figures);
    const auto matches = match_descriptors(a, b);
    const auto screened = screen_look_alikes(matches, a.descriptors.type() == CV_8UC1);
    PairFigures found = measure_pair(b, matches, screened, true_sights(pair, a, pairs.camera));
    found.inliers = pair.H_b_a ? count_homography_inliers(a, b, screened)
                               : count_motion_inliers(a, pair.a.depth_m, b, screened, pairs.camera);
    figures.pairs.push_back(std::move(found));
    if (pictures.empty() || i != pairs.pairs.size() / 2) continue;
    write_picture(pictures / (detector.id + "_all.png"),
                  draw_matches(pair.a.gray, a, pair.b.gray, b, matches));
    write_picture(pictures / (detector.id + "_screened.png"),
                  draw_matches(pair.a.gray, a, pair.b.gray, b, screened));
  }
  return figures;
}

double share(double part, double whole) {
  return whole > 0 ? part / whole : 0;
}

/// One row of the table, in the order of its columns.
struct Summary {
  double key_points = 0, milliseconds = 0, matches = 0, screened = 0, inliers = 0;  ///< medians
  double repeatability = 0, precision = 0;  ///< of all pairs together; 0 without ground truth
  double error_px = 0;                      ///< median
  bool with_truth = false;
};

Summary summarise(const DetectorFigures& figures) {
  std::vector<double> matches, screened, inliers, errors_px;
  double visible = 0, repeated = 0, checked = 0, right = 0;
  for (const PairFigures& pair : figures.pairs) {
    matches.push_back(static_cast<double>(pair.matches));
    screened.push_back(static_cast<double>(pair.screened));
    inliers.push_back(static_cast<double>(pair.inliers));
    errors_px.insert(errors_px.end(), pair.errors_px.begin(), pair.errors_px.end());
    visible += static_cast<double>(pair.visible);
    repeated += static_cast<double>(pair.repeated);
    checked += static_cast<double>(pair.checked);
    right += static_cast<double>(pair.right);
  }
  return {median(figures.key_points),
          median(figures.milliseconds),
          median(matches),
          median(screened),
          median(inliers),
          share(repeated, visible),
          share(right, checked),
          median(errors_px),
          visible > 0};
}

}  // namespace

std::vector<DetectorFigures> compare_detectors(const ComparisonArguments& arguments) {
  const bool single = std::filesystem::is_regular_file(arguments.input);
  const Pairs pairs = single ? pair_of_image(arguments.input) : pairs_of_sequence(arguments);
  std::vector<DetectorFigures> figures;
  std::string known;
  for (const Detector& detector : make_detectors(arguments.features, pairs.camera)) {
    known += " " + detector.id;
    const auto& wanted = arguments.wanted;
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), detector.id) != wanted.end()) {
      figures.push_back(measure(detector, pairs, arguments.pictures));
    }
  }
  if (figures.size() < arguments.wanted.size() || figures.empty()) {
    throw UsageError(fmt::format("--detectors: this build has{}", known));
  }
  return figures;
}

std::string comparison_table(const std::vector<DetectorFigures>& figures) {
  std::string table =
      fmt::format("{:<14} {:>10} {:>8} {:>8} {:>9} {:>8} {:>14} {:>10} {:>9}\n", "", "key points", "ms",
                  "matches", "screened", "inliers", "repeatability", "precision", "error px");
  for (const DetectorFigures& detector : figures) {
    const Summary s = summarise(detector);
    table += fmt::format("{:<14} {:>10.0f} {:>8.2f} {:>8.0f} {:>9.0f} {:>8.0f}", detector.name, s.key_points,
                         s.milliseconds, s.matches, s.screened, s.inliers);
    table += s.with_truth ? fmt::format(" {:>12.1f} % {:>8.1f} % {:>9.2f}\n", 100 * s.repeatability,
                                        100 * s.precision, s.error_px)
                          : fmt::format(" {:>14} {:>10} {:>9}\n", "-", "-", "-");
  }
  return table;
}

nlohmann::json comparison_json(const std::vector<DetectorFigures>& figures) {
  nlohmann::json list = nlohmann::json::array();
  for (const DetectorFigures& detector : figures) {
    const Summary s = summarise(detector);
    nlohmann::json entry = {{"detector", detector.id},
                            {"name", detector.name},
                            {"images", detector.key_points.size()},
                            {"pairs", detector.pairs.size()},
                            {"key_points", s.key_points},
                            {"milliseconds", s.milliseconds},
                            {"matches", s.matches},
                            {"screened", s.screened},
                            {"inliers", s.inliers}};
    if (s.with_truth) {
      entry["repeatability"] = s.repeatability;
      entry["precision"] = s.precision;
      entry["error_px"] = s.error_px;
    }
    list.push_back(entry);
  }
  return list;
}

}  // namespace kinloop
