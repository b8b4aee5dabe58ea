#include "kinloop/loop/compare_visits.hpp"

#include <limits>

#include "kinloop/loop/align_views.hpp"
#include "kinloop/map/view_difference.hpp"

namespace kinloop {
namespace {

constexpr double kSigma_m = 0.01, kDriftPerMetre = 0.0075;  // 1 sigma, of the relative position

View view_of(const Keyframe& keyframe) {
  return {*keyframe.features, keyframe.surfaces.get()};
}

}  // namespace

const Keyframe* nearest_view(const Map& map, const SE3& T_world_camera,
                             const std::function<bool(const Keyframe&)>& is_wanted) {
  const Keyframe* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Keyframe& keyframe : map.keyframes()) {
    if (!is_wanted(keyframe)) continue;
    const auto difference = view_difference(keyframe.T_world_camera, T_world_camera);
    if (!difference || *difference >= least) continue;
    least = *difference;
    nearest = &keyframe;
  }
  return nearest;
}

std::optional<ViewComparison> compare_aligned(const Keyframe& a, const Keyframe& b, const SE3& T_a_b,
                                              double away_m, const Sensor& sensor) {
  // 2 to 3 % of the path, see drift.cpp.
  const DriftBound drift{0.05 + 0.03 * away_m, 0.03 + 0.02 * away_m};
  const View view_a = view_of(a), view_b = view_of(b);
  const auto aligned = align_views(view_a, view_b, {T_a_b, drift}, sensor);
  if (!aligned) return std::nullopt;
  return ViewComparison{appearance_p_value(view_a, view_b, aligned->T_reference_camera, sensor.camera),
                        aligned->scale};
}

SE3 T_world_a_world_b(const Map& map, const LoopClosure& loop) {
  return map.keyframe(loop.a).T_world_camera * loop.T_a_b * map.keyframe(loop.b).T_world_camera.inverse();
}

RoomComparison compare_components(const Map& map, const LoopClosure& loop, const Sensor& sensor) {
  const Keyframe &a = map.keyframe(loop.a), &b = map.keyframe(loop.b);
  const SE3 T_worlds = T_world_a_world_b(map, loop);
  RoomComparison comparison;
  for (const Keyframe& keyframe : map.keyframes()) {
    if (keyframe.component != b.component) continue;
    const SE3 T_world_camera = T_worlds * keyframe.T_world_camera;
    const Keyframe* other = nearest_view(map, T_world_camera,
                                         [&](const Keyframe& view) { return view.component == a.component; });
    if (other == nullptr) continue;
    const double away_m = (keyframe.T_world_camera.translation - b.T_world_camera.translation).norm();
    const SE3 T_other_camera = other->T_world_camera.inverse() * T_world_camera;
    comparison.depths += compare_depths(view_of(*other), view_of(keyframe), T_other_camera, sensor,
                                        kSigma_m + kDriftPerMetre * away_m);
    const auto views = compare_aligned(*other, keyframe, T_other_camera, away_m, sensor);
    if (views) comparison.looks.add(*views);
  }
  return comparison;
}

bool refutes_same_room(const RoomComparison& comparison) {
  constexpr double kMaxViolations = 0.02;  // of all keypoints, see docs/place.md; edges of depth cause some
  return comparison.looks.refute_same_place() || violates_free_space(comparison.depths, kMaxViolations);
}

}  // namespace kinloop
