#include "kinloop/mapping/mapper.hpp"

#include "kinloop/mapping/landmark_creation.hpp"
#include "kinloop/sensor/surfaces/surface_mask.hpp"
#include "kinloop/tracking/direct/patch_search.hpp"
#include "kinloop/tracking/evidence/moved_points.hpp"
#include "kinloop/tracking/motion/motion_compensation.hpp"

namespace kinloop {
namespace {

/// Which keypoints observe a landmark.
std::vector<bool> observed(const Map& map, KeyframeId id) {
  std::vector<bool> result;
  for (const LandmarkId landmark : map.keyframe(id).landmark_of) result.push_back(landmark.valid());
  return result;
}

/// The first camera defines the world frame. A new component starts at the last known camera pose, for lack
/// of a better estimate.
KeyframeId add_keyframe(Map& map, const TrackedFrame& tracked) {
  const auto add = [&](const SE3& T_world_camera, uint32_t component) {
    return map.add_keyframe(tracked.id, tracked.stamp_ns, T_world_camera, tracked.frame->features, component);
  };
  if (tracked.is_located()) {
    const Keyframe& reference = map.keyframe(tracked.reference);
    return add(reference.T_world_camera * tracked.T_reference_camera, reference.component);
  }
  const SE3 T_world_last = map.keyframes().empty() ? SE3{} : map.keyframes().back().T_world_camera;
  return add(T_world_last, map.component_count());
}

/// The points that have moved, by surfaces of more keyframes than tracking compares, or by tracking.
cv::Mat all_moved(const LocalMap& before, const TrackedFrame& tracked) {
  if (!tracked.is_located()) return {};
  return marked_in_either(moved_points(before, *tracked.frame, tracked.T_reference_camera), tracked.moved);
}

}  // namespace

/// Moves the keypoints of a new keyframe to where its landmarks are found by their patches in earlier
/// keyframes, whose local map is `before`.
void Mapper::refine_observations(Map& map, KeyframeId id, const LocalMap& before, const TrackedFrame& tracked,
                                 const Sensor& sensor) const {
  const Keyframe& keyframe = map.keyframe(id);
  std::vector<LandmarkMatch> matches;
  for (uint32_t feature = 0; feature < keyframe.landmark_of.size(); ++feature) {
    if (keyframe.landmark_of[feature].valid()) matches.push_back({keyframe.landmark_of[feature], feature});
  }
  const Features refined = refine_keypoints(*tracked.frame, matches, tracked.T_reference_camera,
                                            {before, sensor, tracked.velocity});
  map.set_features(id, std::make_shared<const Features>(deskew_features(refined, sensor, tracked.velocity)));
}

KeyframeId Mapper::insert(Map& map, const TrackedFrame& tracked, const Sensor& sensor) const {
  LocalMap before;  // as seen from earlier keyframes
  if (tracked.is_located()) before = make_local_map(map, tracked.reference, options_.local_map);
  const KeyframeId id = add_keyframe(map, tracked);
  add_observations(map, id, tracked.matches);
  match_local_map(map, id, make_local_map(map, id, options_.local_map), sensor.camera, options_.mapping);
  if (tracked.is_located()) refine_observations(map, id, before, tracked, sensor);
  const cv::Mat moved = all_moved(before, tracked);
  map.set_surfaces(id, moved.empty() ? tracked.frame->surfaces
                                     : std::make_shared<const SurfaceGrid>(
                                           without_points(*tracked.frame->surfaces, moved)));
  create_landmarks_from_depth(map, id, sensor.camera, options_.mapping, moved);
  triangulate_landmarks(map, id, sensor.camera, options_.mapping);
  cull_landmarks(map, options_.mapping);
  map.set_patches(id, cut_patches(tracked.frame->octaves, *map.keyframe(id).features, observed(map, id)));
  return id;
}

void Mapper::compensate_first(Map& map, KeyframeId id, const Velocity& velocity, const Sensor& sensor) const {
  const auto features =
      std::make_shared<const Features>(deskew_features(*map.keyframe(id).features, sensor, velocity));
  MapUpdate update;
  update.newest_keyframe = id;
  update.epoch = map.epoch();
  for (uint32_t i = 0; i < features->size(); ++i) {
    const LandmarkId landmark = map.keyframe(id).landmark_of[i];
    const auto depth_m = static_cast<double>(features->depths_m[i]);
    if (!landmark.valid() || !(depth_m > 0)) continue;
    const Eigen::Vector3d p_camera = sensor.camera.unproject(features->pixels[i].cast<double>(), depth_m);
    update.p_world.emplace_back(landmark, map.keyframe(id).T_world_camera * p_camera);
  }
  map.set_features(id, features);
  map.apply(update);
}

}  // namespace kinloop
