#include "kinloop/mapping/landmark_creation.hpp"

#include <cmath>

#include "kinloop/sensor/surfaces/surface_mask.hpp"

namespace kinloop {

void add_observations(Map& map, KeyframeId keyframe, const std::vector<LandmarkMatch>& matches) {
  for (const LandmarkMatch& match : matches) {
    if (map.contains(match.landmark)) map.add_observation(match.landmark, {keyframe, match.feature});
  }
}

std::vector<LandmarkMatch> find_unobserved_landmarks(const Map& map, KeyframeId id, const LocalMap& local_map,
                                                     const PinholeCamera& camera,
                                                     const MappingOptions& options) {
  const Keyframe& keyframe = map.keyframe(id);
  const Features& features = *keyframe.features;
  std::vector<ProjectedPoint> projected;
  std::vector<LandmarkId> landmarks;
  std::vector<bool> seen;
  for (const LandmarkId landmark : keyframe.landmark_of) {
    if (!landmark.valid()) continue;
    if (landmark.value >= seen.size()) seen.resize(landmark.value + 1, false);
    seen[landmark.value] = true;
  }
  const LandmarkProjector project{local_map, features, camera, SE3{}, options.local_map_window_px};
  for (uint32_t i = 0; i < local_map.size(); ++i) {
    if (local_map.ids[i].value < seen.size() && seen[local_map.ids[i].value]) continue;
    const auto expected = project(i);
    if (!expected) continue;
    projected.push_back(*expected);
    landmarks.push_back(local_map.ids[i]);
  }
  const FeatureGrid grid(features, camera.width, camera.height);
  std::vector<LandmarkMatch> found;
  for (const Match& match : match_by_projection(projected, features, grid, {})) {
    found.push_back({landmarks[match.a], match.b});
  }
  return found;
}

int match_local_map(Map& map, KeyframeId id, const LocalMap& local_map, const PinholeCamera& camera,
                    const MappingOptions& options) {
  int matched = 0;
  for (const auto& [landmark, feature] : find_unobserved_landmarks(map, id, local_map, camera, options)) {
    matched += map.add_observation(landmark, {id, feature}) ? 1 : 0;
  }
  return matched;
}

int create_landmarks_from_depth(Map& map, KeyframeId id, const PinholeCamera& camera,
                                const MappingOptions& options, const cv::Mat& moved) {
  const auto features = map.keyframe(id).features;
  const auto surfaces = map.keyframe(id).surfaces;
  int created = 0;
  for (uint32_t i = 0; i < features->size(); ++i) {
    const double depth_m = static_cast<double>(features->depths_m[i]);
    if (!(depth_m > 0) || depth_m > options.max_depth_m || map.keyframe(id).landmark_of[i].valid()) continue;
    if (surfaces && is_marked(moved, *surfaces->camera, features->measured_pixels[i])) continue;
    map.add_landmark(id, i, camera.unproject(features->pixels[i].cast<double>(), depth_m));
    ++created;
  }
  return created;
}

int cull_landmarks(Map& map, const MappingOptions& options) {
  const auto newest = static_cast<int>(map.keyframes().size()) - 1;
  const int judged = newest - options.cull_after_keyframes;
  if (judged < 0) return 0;
  const KeyframeId born{static_cast<uint32_t>(judged)};
  const auto landmarks = map.keyframe(born).landmark_of;
  int culled = 0;
  for (const LandmarkId id : landmarks) {
    if (!id.valid() || map.landmark(id).anchor != born) continue;
    if (static_cast<int>(map.landmark(id).observations.size()) >= options.cull_min_observations) continue;
    map.erase(id);
    ++culled;
  }
  return culled;
}

}  // namespace kinloop
