#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "apps/run/summary/loop_pictures.hpp"

namespace kinloop {
namespace {

constexpr int kMinOverlapLandmarks = 15;  // shared landmarks required for covisibility, as in the local map

/// One end of the loop and its covisible keyframes on the same side.
std::vector<KeyframeId> same_side_keyframes(const Map& map, KeyframeId end, uint32_t loop_length) {
  std::vector<KeyframeId> keyframes{end};
  for (const auto& [neighbour, shared] : map.covisible_keyframes(end, kMinOverlapLandmarks)) {
    const uint32_t distance = std::max(neighbour.value, end.value) - std::min(neighbour.value, end.value);
    if (3 * distance < loop_length) keyframes.push_back(neighbour);
  }
  return keyframes;
}

int count_shared(const std::unordered_set<LandmarkId>& landmarks, const Keyframe& keyframe) {
  return static_cast<int>(std::count_if(keyframe.landmark_of.begin(), keyframe.landmark_of.end(),
                                        [&](LandmarkId id) { return landmarks.contains(id); }));
}

std::unordered_set<LandmarkId> landmarks_of(const Keyframe& keyframe) {
  std::unordered_set<LandmarkId> landmarks(keyframe.landmark_of.begin(), keyframe.landmark_of.end());
  landmarks.erase(LandmarkId{});
  return landmarks;
}

/// Projects a point given in camera axes at the stamp; nullopt if behind the camera or outside the image.
std::optional<Eigen::Vector2d> pixel_in_image(const Eigen::Vector3d& p_camera, const MovingSensor& moving) {
  const PinholeCamera& camera = moving.sensor.camera;
  // Far outside the image the distortion polynomial may map points back into it.
  if (!(p_camera.z() > 0) || !camera.contains(camera.project(p_camera), -0.5 * camera.width))
    return std::nullopt;
  const auto raw = raw_pixel_of(moving.sensor, p_camera, moving.velocity);
  return raw && camera.contains(*raw) ? raw : std::nullopt;
}

}  // namespace

KeyframePair most_overlapping_pair(const Map& map, const LoopClosure& loop) {
  const auto [older_end, newer_end] = std::minmax(loop.a, loop.b);
  const uint32_t length = newer_end.value - older_end.value;
  const auto newer_side = same_side_keyframes(map, newer_end, length);
  KeyframePair best{older_end, newer_end, -1};
  for (const KeyframeId older : same_side_keyframes(map, older_end, length)) {
    const auto landmarks = landmarks_of(map.keyframe(older));
    for (const KeyframeId newer : newer_side) {
      const int shared = count_shared(landmarks, map.keyframe(newer));
      if (shared > best.shared) best = {older, newer, shared};
    }
  }
  return best;
}

std::vector<ReprojectedLandmark> reproject_landmarks(const Map& map, KeyframeId from, KeyframeId into,
                                                     const MovingSensor& moving) {
  const Keyframe &first = map.keyframe(from), &second = map.keyframe(into);
  std::unordered_map<LandmarkId, size_t> feature_of;  // keypoint of the second keyframe per landmark
  for (size_t i = 0; i < second.landmark_of.size(); ++i) feature_of.emplace(second.landmark_of[i], i);
  const SE3 T_second_world = second.T_world_camera.inverse();
  std::vector<ReprojectedLandmark> landmarks;
  for (size_t i = 0; i < first.landmark_of.size(); ++i) {
    const LandmarkId id = first.landmark_of[i];
    if (!id.valid()) continue;
    const Eigen::Vector3d p_second = T_second_world * map.p_world(id);
    const auto predicted = pixel_in_image(p_second, moving);
    if (!predicted) continue;
    ReprojectedLandmark landmark{first.features->raw_pixels[i].cast<double>(), *predicted, p_second.z(), {}};
    if (const auto again = feature_of.find(id); again != feature_of.end())
      landmark.observed_in_second = second.features->raw_pixels[again->second].cast<double>();
    landmarks.push_back(landmark);
  }
  return landmarks;
}

}  // namespace kinloop
