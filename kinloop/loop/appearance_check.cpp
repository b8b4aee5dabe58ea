#include "kinloop/loop/appearance_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "kinloop/features/hamming.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/loop/reproject.hpp"

namespace kinloop {
namespace {

constexpr int kMaxDistance = 80;  // bits
constexpr double kWindow_px = 5;  // half side, on level 0
constexpr double kMaxLevelStep = 2;
constexpr double kBorder_px = 16;  // no keypoints are detected there
constexpr double kOcclusionRadius_px = 40;
constexpr size_t kOcclusionNeighbors = 3;
// Relative depth difference of neighbours on one surface, as in guided matching.
constexpr double kMaxDepthError = 0.15;
constexpr int kRegionSize = 100;  // keypoints
constexpr double kRegionStep_px = 40;

/// A keypoint expected in the view.
struct ExpectedKeypoint {
  Eigen::Vector2d pixel;
  bool found = false;
};

/// Keypoints of one view to be found in another.
class ViewMatcher {
 public:
  ViewMatcher(const Features& features, const PinholeCamera& camera)
      : features_(features), grid_(features, camera.width, camera.height) {}

  [[nodiscard]] bool contains_match(const uint8_t* descriptor, const Eigen::Vector2d& pixel, double level) {
    const double radius_px = kWindow_px * std::pow(features_.scale_factor, std::max(level, 0.0));
    grid_.features_in_area(pixel, radius_px, near_);
    return std::any_of(near_.begin(), near_.end(), [&](uint32_t i) {
      return std::abs(features_.levels[i] - level) < kMaxLevelStep &&
             hamming_distance(descriptor, features_.descriptors.ptr<uint8_t>(static_cast<int>(i))) <=
                 kMaxDistance;
    });
  }

  /// Whether the keypoint is occluded: the nearest keypoints of the view are all at other depths.
  [[nodiscard]] bool occludes(const Reprojection& point) {
    grid_.features_in_area(point.pixel, kOcclusionRadius_px, near_);
    std::erase_if(near_, [&](uint32_t i) { return !(features_.depths_m[i] > 0); });
    const auto distance = [&](uint32_t i) {
      return (features_.pixels[i].cast<double>() - point.pixel).squaredNorm();
    };
    const size_t count = std::min(kOcclusionNeighbors, near_.size());
    std::partial_sort(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(count), near_.end(),
                      [&](uint32_t i, uint32_t j) { return distance(i) < distance(j); });
    return count > 0 &&
           std::all_of(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(count), [&](uint32_t i) {
             return std::abs(static_cast<double>(features_.depths_m[i]) - point.depth_m) >
                    kMaxDepthError * point.depth_m;
           });
  }

 private:
  const Features& features_;
  FeatureGrid grid_;
  std::vector<uint32_t> near_;
};

/// Returns the keypoints of `points` expected in `view`, and whether each was found.
std::vector<ExpectedKeypoint> find_expected_keypoints(const Features& features, const Features& points,
                                                      const SE3& T_view_points, const PinholeCamera& camera) {
  ViewMatcher view(features, camera);
  std::vector<ExpectedKeypoint> expected;
  for (uint32_t i = 0; i < points.size(); ++i) {
    const auto seen = reproject(points, i, T_view_points, camera, kBorder_px);
    if (!seen) continue;
    const double level =
        points.levels[i] + std::log(seen->source_depth_m / seen->depth_m) / std::log(points.scale_factor);
    if (level < -0.5 || level > features.level_count - 0.5) continue;
    const bool found =
        view.contains_match(points.descriptors.ptr<uint8_t>(static_cast<int>(i)), seen->pixel, level);
    if (found || !view.occludes(*seen)) expected.push_back({seen->pixel, found});
  }
  return expected;
}

/// Returns how many of the `kRegionSize` keypoints nearest to `center` were found.
int count_found_near(const Eigen::Vector2d& center, std::vector<ExpectedKeypoint>& expected) {
  std::nth_element(expected.begin(), expected.begin() + kRegionSize, expected.end(),
                   [&](const ExpectedKeypoint& a, const ExpectedKeypoint& b) {
                     return (a.pixel - center).squaredNorm() < (b.pixel - center).squaredNorm();
                   });
  return static_cast<int>(std::count_if(expected.begin(), expected.begin() + kRegionSize,
                                        [](const ExpectedKeypoint& e) { return e.found; }));
}

/// Returns the probability that at most `most` of `kRegionSize` keypoints are found, each with probability p.
double binomial_tail(int most, double p) {
  double term = std::pow(1 - p, kRegionSize), sum = term;
  for (int x = 0; x < most; ++x) {
    term *= p / (1 - p) * (kRegionSize - x) / (x + 1);
    sum += term;
  }
  return std::min(sum, 1.0);
}

double one_way_p_value(const Features& view, const Features& points, const SE3& T_view_points,
                       const PinholeCamera& camera) {
  auto expected = find_expected_keypoints(view, points, T_view_points, camera);
  if (expected.size() < 2 * kRegionSize) return 1;
  int fewest = kRegionSize;
  for (double y = kRegionStep_px / 2; y < camera.height; y += kRegionStep_px) {
    for (double x = kRegionStep_px / 2; x < camera.width; x += kRegionStep_px) {
      fewest = std::min(fewest, count_found_near({x, y}, expected));
    }
  }
  const auto found =
      std::count_if(expected.begin(), expected.end(), [](const ExpectedKeypoint& e) { return e.found; });
  // Blur, illumination and slant leave at least this much of a region.
  constexpr double kMinRelativeRate = 1.0 / 3;
  return binomial_tail(fewest,
                       kMinRelativeRate * static_cast<double>(found) / static_cast<double>(expected.size()));
}

}  // namespace

double appearance_p_value(const Features& a, const Features& b, const SE3& T_a_b,
                          const PinholeCamera& camera) {
  return std::min(one_way_p_value(a, b, T_a_b, camera), one_way_p_value(b, a, T_a_b.inverse(), camera));
}

}  // namespace kinloop
