#include "kinloop/loop/verification/view_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include "kinloop/features/hamming.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/loop/recognition/reproject.hpp"
#include "kinloop/loop/verification/relative_scale.hpp"

namespace kinloop {
namespace {

// The check of depth.

constexpr double kNeighborhood_px = 8;  // radius around a keypoint in which its depth gradient was measured
constexpr double kSigmas = 3;
constexpr int kMaxDepthOutliers = 2;  // gross depth errors are rare but do occur

/// Whether the depth around a keypoint is planar, i.e. not at a depth edge.
bool on_plane(const Features& features, uint32_t index) {
  return features.depths_m[index] > 0 && index < features.inverse_depth_gradients.size() &&
         features.inverse_depth_gradients[index].allFinite();
}

/// Returns the inverse depth of a point minus that of the surface at its pixel, using the best fitting of the
/// planes measured nearby. nullopt if there is none.
std::optional<double> inverse_depth_difference(const Eigen::Vector2d& pixel, double inverse_depth,
                                               const Features& view, const FeatureGrid& grid,
                                               std::vector<uint32_t>& near) {
  grid.features_in_area(pixel, kNeighborhood_px, near);
  std::optional<double> least;
  for (const uint32_t i : near) {
    if (!on_plane(view, i)) continue;
    const Eigen::Vector2d step = pixel - view.pixels[i].cast<double>();
    const double surface =
        1 / static_cast<double>(view.depths_m[i]) + view.inverse_depth_gradients[i].cast<double>().dot(step);
    const double before = inverse_depth - surface;
    if (!least || std::abs(before) < std::abs(*least)) least = before;
  }
  return least;
}

/// Compares the keypoints at rest of `points_view` with the surfaces of `view`.
DepthConsistency check_against_view(const Features& view, const View& points_view, const SE3& T_view_points,
                                    const Sensor& sensor, double position_sigma_m) {
  const Features& points = points_view.features;
  const DepthNoise& noise = sensor.noise.plane;
  const FeatureGrid grid(view, sensor.camera.width, sensor.camera.height);
  DepthConsistency depths;
  std::vector<uint32_t> near;
  for (uint32_t i = 0; i < points.size(); ++i) {
    if (!on_plane(points, i)) continue;
    const auto seen = reproject(points, i, T_view_points, sensor.camera, 0);
    if (!seen || !is_at_rest(seen->p_source, points_view)) continue;
    const auto before = inverse_depth_difference(seen->pixel, 1 / seen->p_view.z(), view, grid, near);
    if (!before) continue;
    // d(1/z) = dz / z^2 for the noise of the point and of the pose, plus the noise of the surface.
    const double z2 = seen->p_view.z() * seen->p_view.z();
    const double source2 = seen->p_source.z() * seen->p_source.z();
    const double of_surface = noise.inverse_sigma_per_m(1 / seen->p_view.z() - *before);
    const double of_source = noise.inverse_sigma_per_m(1 / seen->p_source.z());
    const double tolerance =
        kSigmas * std::hypot(of_surface, of_source * source2 / z2, position_sigma_m / z2);
    if (std::abs(*before) <= tolerance) ++depths.consistent;
    if (*before > tolerance) ++depths.free_space_violations;
  }
  return depths;
}

// The check of appearance.

constexpr int kMaxDistance = 80;  // bits
constexpr double kWindow_px = 5;  // half side, on level 0
constexpr double kMaxLevelStep = 2;
constexpr double kBorder_px = 16;  // no keypoints are detected there
constexpr double kOcclusionRadius_px = 40;
constexpr size_t kOcclusionNeighbors = 3;
// Relative depth difference of neighbours on one surface, as in guided matching.
constexpr double kMaxDepthError = 0.15;
constexpr int kRegionSize = 100;  // keypoints
constexpr int kRegionStep_px = 40;

/// Keypoints expected in the view. By coordinate, since loops over all of them take most of the time.
struct ExpectedKeypoints {
  std::vector<float> x, y;     // px
  std::vector<int32_t> found;  // 1 or 0

  [[nodiscard]] size_t size() const { return x.size(); }

  void add(const Eigen::Vector2d& pixel, bool is_found) {
    x.push_back(static_cast<float>(pixel.x()));
    y.push_back(static_cast<float>(pixel.y()));
    found.push_back(is_found ? 1 : 0);
  }
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
             return std::abs(static_cast<double>(features_.depths_m[i]) - point.p_view.z()) >
                    kMaxDepthError * point.p_view.z();
           });
  }

 private:
  const Features& features_;
  FeatureGrid grid_;
  std::vector<uint32_t> near_;
};

/// Returns the keypoints of `points` expected in `view`, and whether each was found.
ExpectedKeypoints find_expected_keypoints(const View& view, const View& points, const SE3& T_view_points,
                                          const PinholeCamera& camera) {
  const Features& features = points.features;
  ViewMatcher matcher(view.features, camera);
  ExpectedKeypoints expected;
  for (uint32_t i = 0; i < features.size(); ++i) {
    const auto seen = reproject(features, i, T_view_points, camera, kBorder_px);
    if (!seen) continue;
    const double level = features.levels[i] + seen->level_step(features.scale_factor);
    if (level < -0.5 || level > view.features.level_count - 0.5) continue;
    const bool found =
        matcher.contains_match(features.descriptors.ptr<uint8_t>(static_cast<int>(i)), seen->pixel, level);
    const auto is_missing = [&] {
      return is_at_rest(seen->p_source, points) && is_at_rest(seen->p_view, view) && !matcher.occludes(*seen);
    };
    if (found || is_missing()) expected.add(seen->pixel, found);
  }
  return expected;
}

/// Returns keys that ascend with the distance from a pixel; the lowest bit says whether the keypoint was
/// found.
std::vector<int32_t> distance_keys(float x, float y, const ExpectedKeypoints& expected) {
  constexpr float kPerSquaredPixel = 8;
  std::vector<int32_t> keys(expected.size());
  for (size_t i = 0; i < keys.size(); ++i) {
    const float dx = expected.x[i] - x, dy = expected.y[i] - y;
    keys[i] = 2 * static_cast<int32_t>(kPerSquaredPixel * (dx * dx + dy * dy)) + expected.found[i];
  }
  return keys;
}

/// Returns a limit that `kRegionSize` keys do not exceed, or more only if they are equal to it. By bisection:
/// several passes without branches take less time than partial sorting.
int32_t limit_of_region(const std::vector<int32_t>& keys) {
  int32_t low = 0, high = 0;
  for (const int32_t key : keys) high |= key;
  while (low < high) {
    const int32_t middle = std::midpoint(low, high);
    int count = 0;
    for (const int32_t key : keys) count += static_cast<int>(key <= middle);
    if (count == kRegionSize) return middle;
    if (count > kRegionSize) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

/// Returns how many of the `kRegionSize` keypoints nearest to a pixel were found.
int count_found_near(float x, float y, const ExpectedKeypoints& expected) {
  const std::vector<int32_t> keys = distance_keys(x, y, expected);
  const int32_t limit = limit_of_region(keys);
  int count = 0, found = 0;
  for (const int32_t key : keys) {
    const int32_t is_nearer = key < limit ? 1 : 0;
    count += is_nearer;
    found += is_nearer & key;
  }
  return found + (kRegionSize - count) * (limit & 1);
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

double one_way_p_value(const View& view, const View& points, const SE3& T_view_points,
                       const PinholeCamera& camera) {
  const auto expected = find_expected_keypoints(view, points, T_view_points, camera);
  if (expected.size() < 2 * kRegionSize) return 1;
  int fewest = kRegionSize;
  for (int y = kRegionStep_px / 2; y < camera.height; y += kRegionStep_px) {
    for (int x = kRegionStep_px / 2; x < camera.width; x += kRegionStep_px) {
      fewest = std::min(fewest, count_found_near(static_cast<float>(x), static_cast<float>(y), expected));
    }
  }
  const int found = std::accumulate(expected.found.begin(), expected.found.end(), 0);
  // Blur, illumination and slant leave at least this much of a region.
  constexpr double kMinRelativeRate = 1.0 / 3;
  return binomial_tail(fewest, kMinRelativeRate * found / static_cast<double>(expected.size()));
}

}  // namespace

bool is_at_rest(const Eigen::Vector3d& p_view, const View& view) {
  return view.surfaces == nullptr || state_in_view(p_view, *view.surfaces) == PointState::kConsistent;
}

DepthConsistency& DepthConsistency::operator+=(const DepthConsistency& other) {
  consistent += other.consistent;
  free_space_violations += other.free_space_violations;
  return *this;
}

DepthConsistency compare_depths(const View& a, const View& b, const SE3& T_a_b, const Sensor& sensor,
                                double position_sigma_m) {
  DepthConsistency depths = check_against_view(a.features, b, T_a_b, sensor, position_sigma_m);
  depths += check_against_view(b.features, a, T_a_b.inverse(), sensor, position_sigma_m);
  return depths;
}

bool contradicts_free_space(const DepthConsistency& depths, double max_violation_ratio) {
  return depths.free_space_violations > kMaxDepthOutliers &&
         depths.free_space_violations >
             max_violation_ratio * (depths.consistent + depths.free_space_violations);
}

double appearance_p_value(const View& a, const View& b, const SE3& T_a_b, const PinholeCamera& camera) {
  return std::min(one_way_p_value(a, b, T_a_b, camera), one_way_p_value(b, a, T_a_b.inverse(), camera));
}

void AppearanceTally::add(const ViewComparison& comparison) {
  constexpr double kMinPValue = 1e-3;
  // Of aligned views of one room, 1 of 325 differ by more, and 1 of 18 in redkitchen from afar.
  constexpr double kMaxScaleDifference = 0.015;
  ++views;
  if (comparison.appearance_p_value < kMinPValue ||
      contradicts_equal_size(comparison.scale, kMaxScaleDifference))
    ++different_views;
}

bool AppearanceTally::contradicts_same_place() const {
  // Of pairs of keyframes in the rooms 100 to 104, at most 4 % look different where the room is the same, 11
  // % where chairs were pushed, and at least 41 % on another floor with the same desks. Of frames that were
  // located in the rooms 101, 103 and 104, none, at most 10 %, and at least 33 %.
  constexpr double kMaxDifferent = 0.25;
  constexpr int kMinViews = 4;
  return views >= kMinViews && different_views > kMaxDifferent * views;
}

}  // namespace kinloop
