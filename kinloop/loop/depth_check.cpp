#include "kinloop/loop/depth_check.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include "kinloop/features/matcher.hpp"
#include "kinloop/loop/reproject.hpp"

namespace kinloop {
namespace {

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

/// Compares the keypoints of `points` with the surfaces of `view`.
DepthConsistency check_against_view(const Features& view, const Features& points, const SE3& T_view_points,
                                    const Sensor& sensor, double position_sigma_m) {
  const DepthNoise& noise = sensor.noise.plane;
  const FeatureGrid grid(view, sensor.camera.width, sensor.camera.height);
  DepthConsistency depths;
  std::vector<uint32_t> near;
  for (uint32_t i = 0; i < points.size(); ++i) {
    if (!on_plane(points, i)) continue;
    const auto seen = reproject(points, i, T_view_points, sensor.camera, 0);
    if (!seen) continue;
    const auto before = inverse_depth_difference(seen->pixel, 1 / seen->depth_m, view, grid, near);
    if (!before) continue;
    // d(1/z) = dz / z^2 for the noise of the point and of the pose, plus the noise of the surface.
    const double z2 = seen->depth_m * seen->depth_m;
    const double source2 = seen->source_depth_m * seen->source_depth_m;
    const double of_surface = noise.inverse_sigma_per_m(1 / seen->depth_m - *before);
    const double of_source = noise.inverse_sigma_per_m(1 / seen->source_depth_m);
    const double tolerance =
        kSigmas * std::hypot(of_surface, of_source * source2 / z2, position_sigma_m / z2);
    if (std::abs(*before) <= tolerance) ++depths.consistent;
    if (*before > tolerance) ++depths.free_space_violations;
  }
  return depths;
}

}  // namespace

DepthConsistency& DepthConsistency::operator+=(const DepthConsistency& other) {
  consistent += other.consistent;
  free_space_violations += other.free_space_violations;
  return *this;
}

DepthConsistency compare_depths(const Features& a, const Features& b, const SE3& T_a_b, const Sensor& sensor,
                                double position_sigma_m) {
  DepthConsistency depths = check_against_view(a, b, T_a_b, sensor, position_sigma_m);
  depths += check_against_view(b, a, T_a_b.inverse(), sensor, position_sigma_m);
  return depths;
}

bool violates_free_space(const DepthConsistency& depths, double max_violation_ratio) {
  return depths.free_space_violations > kMaxDepthOutliers &&
         depths.free_space_violations >
             max_violation_ratio * (depths.consistent + depths.free_space_violations);
}

}  // namespace kinloop
