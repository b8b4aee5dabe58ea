#include "kinloop/loop/verification/compare_visits.hpp"

#include <cmath>

#include "kinloop/loop/verification/align_views.hpp"

namespace kinloop {
namespace {

constexpr double kLoopSigma_m = 0.01;  // of the position that a group of loops measures

View seen_by(const KeyframeView& view) {
  return {*view.features, view.surfaces.get()};
}

/// Each view of the component of `loop.b` with the nearest one of the component of `loop.a`.
std::vector<OverlappingViews> overlapping_views(const std::vector<KeyframeView>& all,
                                                const LoopClosure& loop) {
  const KeyframeView &end_a = all[loop.a.value], &end_b = all[loop.b.value];
  const SE3 T_worlds = T_world_a_world_b(loop, end_a.T_world_camera, end_b.T_world_camera);
  std::vector<OverlappingViews> overlapping;
  for (const KeyframeView& b : all) {
    if (b.component != end_b.component) continue;
    const SE3 T_world_camera = T_worlds * b.T_world_camera;
    const KeyframeView* a = nearest_view(
        all, T_world_camera, [&](const KeyframeView& view) { return view.component == end_a.component; });
    if (a == nullptr) continue;
    const double away_m = (b.T_world_camera.translation - end_b.T_world_camera.translation).norm();
    overlapping.push_back({*a, b, a->T_world_camera.inverse() * T_world_camera, away_m});
  }
  return overlapping;
}

RoomComparison compare_room(const std::vector<OverlappingViews>& overlapping, AppearanceCache& cache,
                            const Sensor& sensor) {
  RoomComparison comparison;
  for (const OverlappingViews& views : overlapping) {
    const double sigma_m = std::hypot(kLoopSigma_m, std::sqrt(drift_covariance(views.away_m)(0, 0)));
    comparison.depths += compare_depths(seen_by(views.a), seen_by(views.b), views.T_a_b, sensor, sigma_m);
    if (const auto pair = cache.compare(views, sensor)) comparison.appearance.add(*pair);
  }
  return comparison;
}

}  // namespace

KeyframeView view_of(const Keyframe& keyframe) {
  return {keyframe.id,       keyframe.component, keyframe.visit, keyframe.T_world_camera,
          keyframe.features, keyframe.surfaces};
}

SE3 T_world_a_world_b(const LoopClosure& loop, const SE3& T_world_a, const SE3& T_world_b) {
  return T_world_a * loop.T_a_b * T_world_b.inverse();
}

std::optional<ViewComparison> compare_aligned(const OverlappingViews& views, const Sensor& sensor) {
  const View a = seen_by(views.a), b = seen_by(views.b);
  const auto aligned = align_views(a, b, {views.T_a_b, drift_covariance(views.away_m)}, sensor);
  if (!aligned) return std::nullopt;
  return ViewComparison{appearance_p_value(a, b, aligned->T_reference_camera, sensor.camera), aligned->scale};
}

std::optional<ViewComparison> AppearanceCache::compare(const OverlappingViews& views, const Sensor& sensor) {
  const auto is_near = [&](const SE3& T_a_b) {
    constexpr double kNear = 10;  // of the square up to which alignment allows for drift, 38
    return squared_distance({T_a_b, drift_covariance(views.away_m)}, views.T_a_b) < kNear;
  };
  const auto [known, added] = pairs_.try_emplace({views.a.id, views.b.id});
  if (added || !is_near(known->second.T_a_b)) known->second = {views.T_a_b, compare_aligned(views, sensor)};
  return known->second.comparison;
}

ComparedJoins compare_rooms(const JoinProblem& problem) {
  ComparedJoins compared{{}, problem.cache, problem.epoch};
  for (const auto& [loop, required_views] : problem.joins) {
    const auto overlapping = overlapping_views(problem.views, loop);
    compared.rooms[loop.ends()] = static_cast<int>(overlapping.size()) < required_views
                                      ? RoomComparison{}
                                      : compare_room(overlapping, compared.cache, problem.sensor);
  }
  return compared;
}

bool contradicts_same_room(const RoomComparison& comparison) {
  constexpr double kMaxViolations = 0.02;  // of all keypoints (docs/lab/place.md); edges of depth cause some
  return comparison.appearance.contradicts_same_place() ||
         contradicts_free_space(comparison.depths, kMaxViolations);
}

}  // namespace kinloop
