#include "tools/feature_comparison/evaluate_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/optimize/pose/ransac/pnp_ransac.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {
namespace {

constexpr double kScreenFactor = 4;
constexpr double kMaxDepthStep = 0.04;  // relative, around a keypoint
constexpr double kHiddenShare = 0.05;   // a surface nearer by this fraction occludes what is behind it

Eigen::Vector2d pixel_of(const Features& features, uint32_t index) {
  return features.pixels[index].cast<double>();
}

/// Distance from `pixel` to the nearest keypoint.
double distance_to_nearest(const Features& features, const Eigen::Vector2d& pixel) {
  double nearest = std::numeric_limits<double>::max();
  for (const auto& other : features.pixels) {
    nearest = std::min(nearest, (other.cast<double>() - pixel).squaredNorm());
  }
  return std::sqrt(nearest);
}

/// The matches with nonzero `inliers`.
std::vector<DescriptorMatch> chosen(const std::vector<DescriptorMatch>& matches,
                                    const std::vector<uint8_t>& inliers) {
  std::vector<DescriptorMatch> kept;
  for (size_t i = 0; i < inliers.size(); ++i) {
    if (inliers[i] != 0) kept.push_back(matches[i]);
  }
  return kept;
}

/// Shuffled by seed: OpenCV's RANSAC draws the same list positions every time.
std::vector<DescriptorMatch> in_random_order(const std::vector<DescriptorMatch>& matches, uint64_t seed) {
  Random random(seed);
  const auto count = static_cast<uint32_t>(matches.size());
  std::vector<DescriptorMatch> mixed = matches;
  for (uint32_t i = count; i > 1; --i) std::swap(mixed[i - 1], mixed[random.index(i)]);
  return mixed;
}

/// The inliers of `find`, one of OpenCV's RANSACs.
template <class Find>
std::vector<DescriptorMatch> inliers_of(const MatchedFeatures& pair, uint64_t seed, size_t fewest,
                                        const Find& find) {
  if (pair.matches.size() < fewest) return {};
  const auto matches = in_random_order(pair.matches, seed);
  std::vector<cv::Point2f> from, to;
  for (const DescriptorMatch& match : matches) {
    from.emplace_back(pair.a.pixels[match.a].x(), pair.a.pixels[match.a].y());
    to.emplace_back(pair.b.pixels[match.b].x(), pair.b.pixels[match.b].y());
  }
  cv::Mat inliers;
  find(from, to, inliers);
  if (inliers.empty()) return {};
  return chosen(matches, std::vector<uint8_t>(inliers.begin<uint8_t>(), inliers.end<uint8_t>()));
}

}  // namespace

std::vector<DescriptorMatch> match_descriptors(const Features& a, const Features& b) {
  std::vector<DescriptorMatch> matches;
  if (a.size() == 0 || b.size() == 0) return matches;
  require(a.descriptors.type() == b.descriptors.type(), "match_descriptors: different kinds of descriptors");
  if (a.descriptors.type() == CV_8UC1) {
    for (const Match& match : match_brute_force(a.descriptors, b.descriptors, true)) {
      matches.push_back({match.a, match.b, static_cast<double>(match.distance)});
    }
    return matches;
  }
  std::vector<cv::DMatch> found;
  cv::BFMatcher(cv::NORM_L2, true).match(a.descriptors, b.descriptors, found);
  for (const auto& match : found) {
    matches.push_back({static_cast<uint32_t>(match.queryIdx), static_cast<uint32_t>(match.trainIdx),
                       static_cast<double>(match.distance)});
  }
  return matches;
}

std::vector<DescriptorMatch> filter_by_distance(const std::vector<DescriptorMatch>& matches, bool binary) {
  double smallest = std::numeric_limits<double>::max();
  for (const DescriptorMatch& match : matches) smallest = std::min(smallest, match.distance);
  const double limit = std::max(kScreenFactor * smallest, binary ? double{kMinDistanceLimitBits} : 0.0);
  std::vector<DescriptorMatch> kept;
  std::copy_if(matches.begin(), matches.end(), std::back_inserter(kept),
               [&](const DescriptorMatch& match) { return match.distance <= limit; });
  return kept;
}

GroundTruthPixels ground_truth_pixels_from_motion(const Features& a, const cv::Mat& depth_a_m,
                                                  const cv::Mat& depth_b_m, const PinholeCamera& camera,
                                                  const SE3& T_b_a) {
  GroundTruthPixels true_pixels(a.size());
  for (uint32_t i = 0; i < a.size(); ++i) {
    const double depth_m = average_depth(depth_a_m, a.raw_pixels[i], kMaxDepthStep);
    if (depth_m <= 0) continue;
    const Eigen::Vector3d p_b = T_b_a * camera.unproject(pixel_of(a, i), depth_m);
    if (p_b.z() <= 0) continue;
    const Eigen::Vector2d pixel = camera.project(p_b);
    const Eigen::Vector2d raw = camera.distort(pixel);
    if (!camera.contains(raw, 1)) continue;
    const double seen_m = average_depth(depth_b_m, raw.cast<float>(), kMaxDepthStep);
    if (seen_m > 0 && std::abs(seen_m - p_b.z()) < kHiddenShare * p_b.z()) true_pixels[i] = pixel;
  }
  return true_pixels;
}

GroundTruthPixels ground_truth_pixels_from_homography(const Features& a, const cv::Size& size,
                                                      const Eigen::Matrix3d& H_b_a) {
  GroundTruthPixels true_pixels(a.size());
  for (uint32_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d pixel = (H_b_a * pixel_of(a, i).homogeneous()).hnormalized();
    const bool inside =
        pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= size.width - 1 && pixel.y() <= size.height - 1;
    if (inside) true_pixels[i] = pixel;
  }
  return true_pixels;
}

std::vector<DescriptorMatch> motion_inliers(const MatchedFeatures& pair, const cv::Mat& depth_a_m,
                                            const PinholeCamera& camera, uint64_t seed) {
  std::vector<PoseObservation> observations;
  std::vector<DescriptorMatch> with_depth;
  for (const DescriptorMatch& match : pair.matches) {
    const double depth_m = average_depth(depth_a_m, pair.a.raw_pixels[match.a], kMaxDepthStep);
    if (depth_m <= 0) continue;
    PoseObservation observation;
    observation.p_reference = camera.unproject(pixel_of(pair.a, match.a), depth_m);
    observation.pixel = pixel_of(pair.b, match.b);
    // The same for all levels and detectors, for a fair comparison.
    observation.sigma_px = kRepeatabilityRadiusPx / std::sqrt(NoiseModel().inlier_chi2_pixel);
    observations.push_back(observation);
    with_depth.push_back(match);
  }
  const auto solution = solve_pnp_ransac(Sensor{camera}, observations, {}, {}, seed);
  return solution ? chosen(with_depth, solution->inliers) : std::vector<DescriptorMatch>();
}

std::vector<DescriptorMatch> homography_inliers(const MatchedFeatures& pair, uint64_t seed) {
  constexpr size_t kMinCount = 4;
  return inliers_of(pair, seed, kMinCount, [](const auto& from, const auto& to, cv::Mat& inliers) {
    cv::findHomography(from, to, cv::RANSAC, kRepeatabilityRadiusPx, inliers);
  });
}

std::vector<DescriptorMatch> epipolar_inliers(const MatchedFeatures& pair, uint64_t seed) {
  constexpr size_t kMinCount = 15;  // with fewer, OpenCV uses another method than RANSAC or none
  return inliers_of(pair, seed, kMinCount, [](const auto& from, const auto& to, cv::Mat& inliers) {
    constexpr double kConfidence = 0.999;
    cv::findFundamentalMat(from, to, cv::FM_RANSAC, kRepeatabilityRadiusPx, kConfidence, inliers);
  });
}

PairMetrics evaluate_pair(const Features& b, const std::vector<DescriptorMatch>& matches,
                          const std::vector<DescriptorMatch>& screened,
                          const GroundTruthPixels& true_pixels) {
  PairMetrics metrics;
  metrics.matches = matches.size();
  metrics.screened = screened.size();
  for (const auto& true_pixel : true_pixels) {
    if (!true_pixel) continue;
    ++metrics.visible;
    metrics.repeated += distance_to_nearest(b, *true_pixel) <= kRepeatabilityRadiusPx ? 1 : 0;
  }
  for (const DescriptorMatch& match : screened) {
    if (true_pixels.empty() || !true_pixels[match.a]) continue;
    ++metrics.checked;
    const double error_px = (pixel_of(b, match.b) - *true_pixels[match.a]).norm();
    if (error_px > kRepeatabilityRadiusPx) continue;
    ++metrics.correct;
    metrics.errors_px.push_back(error_px);
  }
  return metrics;
}

}  // namespace kinloop
