#include "kinloop/loop/verification/location_check.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "kinloop/loop/verification/relative_scale.hpp"
#include "kinloop/map/view_difference.hpp"

namespace kinloop {
namespace {

constexpr size_t kViews = 6, kViewsOfAppearance = 3;  // the nearest
/// Of the relative position of a frame that has just been located (1 sigma). With 1 cm, up to 18 % of the
/// keypoints of true poses in redkitchen seem to violate free space, with 3 cm at most 1 %.
constexpr double kPositionSigma_m = 0.03;

double second_smallest(std::vector<double> values) {
  if (values.size() < 2) return 1;
  std::nth_element(values.begin(), values.begin() + 1, values.end());
  return values[1];
}

}  // namespace

LocationEvidence compare_with_views(const Map& map, KeyframeId end, const LocatedView& located,
                                    const Sensor& sensor) {
  const auto& [component, T_world_camera, features] = located;
  std::vector<std::pair<double, KeyframeId>> views;
  for (const Keyframe& keyframe : map.keyframes()) {
    if (!(keyframe.id < end)) break;
    if (keyframe.component != component || keyframe.withdrawn) continue;
    const auto away = view_difference(keyframe.T_world_camera, T_world_camera);
    if (away) views.emplace_back(*away, keyframe.id);
  }
  const size_t count = std::min(kViews, views.size());
  std::partial_sort(views.begin(), views.begin() + static_cast<std::ptrdiff_t>(count), views.end());
  LocationEvidence evidence;
  std::vector<double> p_values;
  for (size_t i = 0; i < count; ++i) {
    const Keyframe& view = map.keyframe(views[i].second);
    const SE3 T_view_camera = view.T_world_camera.inverse() * T_world_camera;
    evidence.depths += compare_depths({*view.features}, {features}, T_view_camera, sensor, kPositionSigma_m);
    if (i < kViewsOfAppearance)
      p_values.push_back(appearance_p_value({*view.features}, {features}, T_view_camera, sensor.camera));
  }
  evidence.appearance_p_value = second_smallest(std::move(p_values));
  return evidence;
}

void LocationCheck::add(const LocationEvidence& evidence, bool confident) {
  constexpr size_t kLatest = 10;
  constexpr int kMinFrames = 2, kMinConfidentFrames = 10, kMinConsistent = 300;
  latest_.push_back(evidence);
  if (latest_.size() > kLatest) latest_.pop_front();
  ++frames_;
  if (confident) ++confident_frames_;
  if (is_contradicted()) return;
  const bool by_depth = frames_ >= kMinFrames && depths().consistent >= kMinConsistent;
  if (by_depth || confident_frames_ >= kMinConfidentFrames) confirmed_ = true;
}

bool LocationCheck::is_contradicted() const {
  // Of true poses in redkitchen, at most 1 % in any frame; in a room's double, a quarter of the frames 6 %.
  constexpr double kMaxViolations = 0.02;
  return contradicts_same_place(scale()) || contradicts_free_space(depths(), kMaxViolations) ||
         appearance_contradicts();
}

bool LocationCheck::appearance_contradicts() const {
  // At least .5 where 28 frames of redkitchen and 12 of rooms 100 to 104 were located, at most 3e-4 in
  // doubles of these rooms, but for one frame.
  constexpr double kMinPValue = 0.01;
  const auto different = std::count_if(latest_.begin(), latest_.end(), [](const LocationEvidence& evidence) {
    return evidence.appearance_p_value < kMinPValue;
  });
  return 2 * static_cast<size_t>(different) > latest_.size() || appearance_.contradicts_same_place();
}

DepthConsistency LocationCheck::depths() const {
  DepthConsistency sum;
  for (const LocationEvidence& evidence : latest_) sum += evidence.depths;
  return sum;
}

RelativeScale LocationCheck::scale() const {
  std::vector<RelativeScale> scales;
  for (const LocationEvidence& evidence : latest_) scales.push_back(evidence.scale);
  return combine(scales);
}

}  // namespace kinloop
