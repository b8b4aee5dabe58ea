#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "kinloop/features/matcher.hpp"
#include "kinloop/mapping/landmark_creation.hpp"

namespace kinloop {
namespace {

/// Keypoints without landmark and without depth.
struct UnmappedKeypoints {
  std::vector<uint32_t> features;
  cv::Mat descriptors;  // one row per keypoint
};

UnmappedKeypoints collect_unmapped(const Keyframe& keyframe, double max_depth_m) {
  const Features& features = *keyframe.features;
  UnmappedKeypoints unmapped;
  for (uint32_t i = 0; i < features.size(); ++i) {
    const auto depth_m = static_cast<double>(features.depths_m[i]);
    if (keyframe.landmark_of[i].valid() || (depth_m > 0 && depth_m <= max_depth_m)) continue;
    unmapped.features.push_back(i);
    unmapped.descriptors.push_back(features.descriptors.row(static_cast<int>(i)));
  }
  return unmapped;
}

Bearing make_bearing(const Features& features, uint32_t feature, const PinholeCamera& camera) {
  const Eigen::Vector2d pixel = features.pixels[feature].cast<double>();
  return {camera.unproject(pixel, 1.0).normalized(),
          static_cast<double>(features.sigmas_px[feature]) / camera.fx};
}

/// Whether keypoints this many levels apart are consistent with one point at these distances.
bool consistent_scale(int levels, double distance_a_m, double distance_b_m, double scale_factor) {
  const double expected_levels = std::log(distance_a_m / distance_b_m) / std::log(scale_factor);
  return std::abs(levels - expected_levels) <= 1.5;
}

int triangulate_pair(Map& map, KeyframeId id, KeyframeId neighbour_id, const PinholeCamera& camera,
                     const MappingOptions& options) {
  constexpr double kMinParallaxRad = 0.03;  // below it depth along the rays is unconstrained
  constexpr int kMaxHammingDistance = 50;   // bits of 256
  const auto a = collect_unmapped(map.keyframe(id), options.max_depth_m);
  const auto b = collect_unmapped(map.keyframe(neighbour_id), options.max_depth_m);
  if (a.features.empty() || b.features.empty()) return 0;
  const auto features_a = map.keyframe(id).features, features_b = map.keyframe(neighbour_id).features;
  const SE3 T_a_b = map.relative_pose(id, neighbour_id);
  int created = 0;
  for (const Match& match : match_brute_force(a.descriptors, b.descriptors, true)) {
    if (match.distance > kMaxHammingDistance) continue;
    const uint32_t i = a.features[match.a], j = b.features[match.b];
    const auto point = triangulate(make_bearing(*features_a, i, camera), make_bearing(*features_b, j, camera),
                                   T_a_b, kMinParallaxRad);
    if (!point) continue;
    if (!consistent_scale(features_b->levels[j] - features_a->levels[i], point->norm(),
                          (*point - T_a_b.translation).norm(), features_a->scale_factor))
      continue;
    map.add_observation(map.add_landmark(id, i, *point), {neighbour_id, j});
    ++created;
  }
  return created;
}

}  // namespace

std::optional<Eigen::Vector3d> triangulate(const Bearing& a, const Bearing& b, const SE3& T_a_b,
                                           double min_parallax_rad) {
  const Eigen::Vector3d& baseline = T_a_b.translation;
  const Eigen::Vector3d ray_b = T_a_b.rotation * b.ray;
  const Eigen::Vector3d normal = a.ray.cross(ray_b);
  const double sine = normal.norm();
  if (!(sine > std::sin(min_parallax_rad)) || a.ray.dot(ray_b) < 0) return std::nullopt;
  // Distances along the rays at their closest approach.
  const double along_a = baseline.cross(ray_b).dot(normal) / (sine * sine);
  const double along_b = baseline.cross(a.ray).dot(normal) / (sine * sine);
  if (!(along_a > 0) || !(along_b > 0)) return std::nullopt;
  // The gap subtends an angle at each camera; the point divides it in proportion to the two uncertainties.
  const double gap_m = std::abs(baseline.dot(normal)) / sine;
  const double off_a_m = along_a * a.sigma_rad, off_b_m = along_b * b.sigma_rad;
  constexpr double kMaxChi2 = 3.841;  // 95 % with one degree of freedom
  const double variance = off_a_m * off_a_m + off_b_m * off_b_m;
  if (gap_m * gap_m > kMaxChi2 * variance) return std::nullopt;
  const Eigen::Vector3d on_a = along_a * a.ray, on_b = baseline + along_b * ray_b;
  return Eigen::Vector3d(on_a + (on_b - on_a) * (off_a_m * off_a_m / variance));
}

int triangulate_landmarks(Map& map, KeyframeId id, const PinholeCamera& camera,
                          const MappingOptions& options) {
  const auto neighbours = map.covisible_keyframes(id, kMinCovisibleLandmarks);
  const size_t count = std::min(neighbours.size(), static_cast<size_t>(options.triangulation_keyframes));
  int created = 0;
  for (size_t i = 0; i < count; ++i)
    created += triangulate_pair(map, id, neighbours[i].first, camera, options);
  return created;
}

}  // namespace kinloop
