#include "kinloop/loop/picture_check.hpp"

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
constexpr double kBorder_px = 16;  // no key points there
constexpr double kSurroundings_px = 40;
constexpr size_t kSurrounding = 3;
constexpr double kMaxDepthError = 0.15;  // of a neighbour on the same thing, as in guided matching
constexpr int kRegion = 100;             // key points
constexpr double kRegionStep_px = 40;

/// A key point that should be in the view.
struct Expected {
  Eigen::Vector2d pixel;
  bool found = false;
};

/// Key points of one view, to be looked for in another.
class View {
 public:
  View(const Features& features, const PinholeCamera& camera)
      : features_(features), grid_(features, camera.width, camera.height) {}

  [[nodiscard]] bool shows(const uint8_t* descriptor, const Eigen::Vector2d& pixel, double level) {
    const double radius_px = kWindow_px * std::pow(features_.scale_factor, std::max(level, 0.0));
    grid_.near(pixel, radius_px, near_);
    return std::any_of(near_.begin(), near_.end(), [&](uint32_t i) {
      return std::abs(features_.levels[i] - level) < kMaxLevelStep &&
             hamming_distance(descriptor, features_.descriptors.ptr<uint8_t>(static_cast<int>(i))) <=
                 kMaxDistance;
    });
  }

  /// Whether something else is there: the nearest key points are all at other depths.
  [[nodiscard]] bool hides(const Reprojection& point) {
    grid_.near(point.pixel, kSurroundings_px, near_);
    std::erase_if(near_, [&](uint32_t i) { return !(features_.depths_m[i] > 0); });
    const auto distance = [&](uint32_t i) {
      return (features_.pixels[i].cast<double>() - point.pixel).squaredNorm();
    };
    const size_t count = std::min(kSurrounding, near_.size());
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

/// The key points of `points` that `view` should show, and whether it does.
std::vector<Expected> expect(const Features& features, const Features& points, const SE3& T_view_points,
                             const PinholeCamera& camera) {
  View view(features, camera);
  std::vector<Expected> expected;
  for (uint32_t i = 0; i < points.size(); ++i) {
    const auto seen = reproject(points, i, T_view_points, camera, kBorder_px);
    if (!seen) continue;
    const double level =
        points.levels[i] + std::log(seen->own_depth_m / seen->depth_m) / std::log(points.scale_factor);
    if (level < -0.5 || level > features.level_count - 0.5) continue;
    const bool found = view.shows(points.descriptors.ptr<uint8_t>(static_cast<int>(i)), seen->pixel, level);
    if (found || !view.hides(*seen)) expected.push_back({seen->pixel, found});
  }
  return expected;
}

/// How many of the `kRegion` nearest to `center` were found.
int found_around(const Eigen::Vector2d& center, std::vector<Expected>& expected) {
  std::nth_element(expected.begin(), expected.begin() + kRegion, expected.end(),
                   [&](const Expected& a, const Expected& b) {
                     return (a.pixel - center).squaredNorm() < (b.pixel - center).squaredNorm();
                   });
  return static_cast<int>(
      std::count_if(expected.begin(), expected.begin() + kRegion, [](const Expected& e) { return e.found; }));
}

/// The probability of at most `most` of `kRegion` where each comes with probability p.
double binomial_tail(int most, double p) {
  double term = std::pow(1 - p, kRegion), sum = term;
  for (int x = 0; x < most; ++x) {
    term *= p / (1 - p) * (kRegion - x) / (x + 1);
    sum += term;
  }
  return std::min(sum, 1.0);
}

double chance_one_way(const Features& view, const Features& points, const SE3& T_view_points,
                      const PinholeCamera& camera) {
  auto expected = expect(view, points, T_view_points, camera);
  if (expected.size() < 2 * kRegion) return 1;
  int fewest = kRegion;
  for (double y = kRegionStep_px / 2; y < camera.height; y += kRegionStep_px) {
    for (double x = kRegionStep_px / 2; x < camera.width; x += kRegionStep_px) {
      fewest = std::min(fewest, found_around({x, y}, expected));
    }
  }
  const auto found =
      std::count_if(expected.begin(), expected.end(), [](const Expected& e) { return e.found; });
  constexpr double kFairShare = 1.0 / 3;  // blur, light and slant leave a region that much at least
  return binomial_tail(fewest,
                       kFairShare * static_cast<double>(found) / static_cast<double>(expected.size()));
}

}  // namespace

double chance_of_difference(const Features& a, const Features& b, const SE3& T_a_b,
                            const PinholeCamera& camera) {
  return std::min(chance_one_way(a, b, T_a_b, camera), chance_one_way(b, a, T_a_b.inverse(), camera));
}

}  // namespace kinloop
