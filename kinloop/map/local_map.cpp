#include "kinloop/map/local_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "kinloop/map/observers.hpp"

namespace kinloop {
namespace {

constexpr double kMinViewingCosine = 0.5;  // descriptors rarely match across a viewpoint change of 60 degrees

/// Predicts the pyramid level of a point at `distance_m` that was seen on level `observed_level` from
/// `observed_distance_m`.
int predict_level(int observed_level, double observed_distance_m, double distance_m,
                  const Features& features) {
  const double level =
      observed_level + std::log(observed_distance_m / distance_m) / std::log(features.scale_factor);
  return std::clamp(static_cast<int>(std::lround(level)), 0, features.level_count - 1);
}

/// Landmarks of `reference` and its covisible keyframes, each once, closest keyframes first.
std::vector<LandmarkId> collect_landmarks(const Map& map, KeyframeId reference,
                                          const LocalMapOptions& options,
                                          std::span<const KeyframeId> others) {
  std::vector<KeyframeId> keyframes{reference};
  keyframes.insert(keyframes.end(), others.begin(), others.end());
  for (const auto& [neighbour, shared] : map.covisible_keyframes(reference, kMinCovisibleLandmarks)) {
    if (keyframes.size() > static_cast<size_t>(options.max_keyframes) + others.size()) break;
    keyframes.push_back(neighbour);
  }
  std::vector<LandmarkId> ids;
  std::vector<bool> taken;
  for (const KeyframeId id : keyframes) {
    for (const LandmarkId landmark : map.keyframe(id).landmark_of) {
      if (!landmark.valid() || ids.size() >= static_cast<size_t>(options.max_landmarks)) continue;
      if (landmark.value >= taken.size()) taken.resize(landmark.value + 1, false);
      if (taken[landmark.value]) continue;
      taken[landmark.value] = true;
      ids.push_back(landmark);
    }
  }
  return ids;
}

/// Whether enough keyframes agree on where a landmark is. Two make a triangulated one agree with any error of
/// their poses.
bool is_confirmed(const Landmark& landmark, bool has_depth) {
  constexpr size_t kMinMeasured = 2, kMinTriangulated = 4;
  return landmark.observations.size() >= (has_depth ? kMinMeasured : kMinTriangulated);
}

/// Reserves space for as many landmarks as there are ids.
void reserve(LocalMap& local_map) {
  const size_t count = local_map.size();
  local_map.index_of.reserve(count);
  local_map.p_reference.reserve(count);
  local_map.has_depth.reserve(count);
  local_map.confirmed.reserve(count);
  local_map.viewing_directions.reserve(count);
  local_map.observed_distances_m.reserve(count);
  local_map.observed_levels.reserve(count);
  local_map.view_of.reserve(count);
  local_map.feature_of.reserve(count);
}

}  // namespace

LocalMap make_local_map(const Map& map, KeyframeId reference, const LocalMapOptions& options,
                        std::span<const KeyframeId> others) {
  LocalMap local_map;
  local_map.reference = reference;
  local_map.features = map.keyframe(reference).features;
  local_map.surfaces = map.keyframe(reference).surfaces;
  local_map.ids = collect_landmarks(map, reference, options, others);
  reserve(local_map);
  for (uint32_t i = 0; i < local_map.size(); ++i) local_map.index_of.emplace(local_map.ids[i], i);
  const SE3 T_reference_world = map.keyframe(reference).T_world_camera.inverse();
  const cv::Mat& like = local_map.features->descriptors;
  std::unordered_map<KeyframeId, uint32_t> view_of;
  local_map.descriptors.create(static_cast<int>(local_map.size()), like.cols, like.type());
  for (size_t i = 0; i < local_map.size(); ++i) {
    const Landmark& landmark = map.landmark(local_map.ids[i]);
    // The latest observation is the most similar to the next view.
    const Observation& seen = landmark.observations.back();
    const Keyframe& observer = map.keyframe(seen.keyframe);
    const Eigen::Vector3d p_reference = T_reference_world * map.p_world(landmark.id);
    const Eigen::Vector3d towards_observer =
        T_reference_world * observer.T_world_camera.translation - p_reference;
    local_map.p_reference.push_back(p_reference);
    local_map.has_depth.push_back(has_measured_depth(landmark, map));
    local_map.confirmed.push_back(is_confirmed(landmark, local_map.has_depth.back()));
    local_map.viewing_directions.push_back(towards_observer.normalized());
    local_map.observed_distances_m.push_back(towards_observer.norm());
    local_map.observed_levels.push_back(observer.features->levels[seen.feature]);
    const auto [view, is_new] =
        view_of.try_emplace(seen.keyframe, static_cast<uint32_t>(local_map.views.size()));
    if (is_new) {
      local_map.views.push_back({seen.keyframe, (T_reference_world * observer.T_world_camera).inverse(),
                                 observer.features, observer.patches, observer.surfaces});
    }
    local_map.view_of.push_back(view->second);
    local_map.feature_of.push_back(seen.feature);
    std::memcpy(local_map.descriptors.ptr(static_cast<int>(i)),
                observer.features->descriptors.ptr(static_cast<int>(seen.feature)),
                local_map.descriptors.step);
  }
  return local_map;
}

int count_with_depth(std::span<const LandmarkMatch> matches, const LocalMap& local_map) {
  return static_cast<int>(std::count_if(matches.begin(), matches.end(), [&](const LandmarkMatch& match) {
    const auto index = local_map.index_of.find(match.landmark);
    return index != local_map.index_of.end() && local_map.has_depth[index->second];
  }));
}

std::optional<ProjectedPoint> LandmarkProjector::operator()(uint32_t index) const {
  const Eigen::Vector3d from_camera = local_map.p_reference[index] - T_reference_camera.translation;
  const Eigen::Vector3d p_camera = T_reference_camera.rotation.conjugate() * from_camera;
  if (!(p_camera.z() > 0)) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(p_camera);
  if (!camera.contains(pixel)) return std::nullopt;
  const double distance_m = from_camera.norm();
  if (-local_map.viewing_directions[index].dot(from_camera) < kMinViewingCosine * distance_m)
    return std::nullopt;
  const int level = predict_level(local_map.observed_levels[index], local_map.observed_distances_m[index],
                                  distance_m, features);
  return ProjectedPoint{pixel,        window_px * std::pow(features.scale_factor, level),
                        p_camera.z(), level - 1,
                        level + 1,    local_map.descriptors.ptr<uint8_t>(static_cast<int>(index))};
}

}  // namespace kinloop
