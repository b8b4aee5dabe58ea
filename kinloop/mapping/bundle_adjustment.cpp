#include "kinloop/mapping/bundle_adjustment.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "kinloop/core/disjoint_sets.hpp"
#include "kinloop/features/keypoint_measurements.hpp"

namespace kinloop {
namespace {

/// Landmarks observed by the keyframes and by at least two keyframes in total, in order of id.
std::vector<LandmarkId> confirmed_landmarks(const Map& map, const std::vector<KeyframeId>& keyframes) {
  std::vector<LandmarkId> ids;
  for (const KeyframeId keyframe : keyframes) {
    for (const LandmarkId id : map.keyframe(keyframe).landmark_of) {
      if (id.valid() && map.landmark(id).observations.size() >= 2) ids.push_back(id);
    }
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

/// Returns at most `max_count` keyframes outside `window` that observe `landmarks`, most observations first.
std::vector<KeyframeId> observers_outside(const Map& map, const std::vector<KeyframeId>& window,
                                          const std::vector<LandmarkId>& landmarks, int max_count) {
  std::vector<int> counts(map.keyframes().size(), 0);  // per keyframe
  for (const LandmarkId id : landmarks) {
    for (const auto& observation : map.landmark(id).observations) ++counts[observation.keyframe.value];
  }
  for (const KeyframeId id : window) counts[id.value] = 0;
  std::vector<KeyframeId> observers;
  for (uint32_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0) observers.push_back(KeyframeId{i});
  }
  std::stable_sort(observers.begin(), observers.end(),
                   [&](KeyframeId a, KeyframeId b) { return counts[a.value] > counts[b.value]; });
  observers.resize(std::min(observers.size(), static_cast<size_t>(max_count)));
  return observers;
}

/// If no pose of a part that landmarks tie together is constant, fixes its oldest one, which removes the
/// gauge freedom.
void fix_gauge(BundleAdjustmentProblem& problem, const Map& map) {
  auto& fixed = problem.bundle.fixed;
  const std::vector<KeyframeId> oldest = oldest_tied(map, problem.keyframes);
  std::map<KeyframeId, size_t> anchor_of;  // by the oldest keyframe of a part
  for (size_t i = 0; i < problem.keyframes.size(); ++i) {
    const auto [anchor, first] = anchor_of.try_emplace(oldest[i], i);
    if (first || fixed[anchor->second] != 0) continue;
    if (fixed[i] != 0 || problem.keyframes[i] == oldest[i]) anchor->second = i;
  }
  for (const auto& [part, anchor] : anchor_of) fixed[anchor] = 1;
}

/// Copies poses and points of the given keyframes and landmarks, and lists their observations.
BundleAdjustmentProblem make_problem(const Map& map, const std::vector<KeyframeId>& keyframes,
                                     size_t free_keyframes, const std::vector<LandmarkId>& landmarks) {
  BundleAdjustmentProblem problem;
  problem.keyframes = keyframes;
  problem.landmarks = landmarks;
  problem.newest_keyframe = map.keyframes().back().id;
  problem.epoch = map.epoch();
  constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
  std::vector<uint32_t> pose_of(map.keyframes().size(), kNone);  // per keyframe
  for (uint32_t i = 0; i < keyframes.size(); ++i) {
    const Keyframe& keyframe = map.keyframe(keyframes[i]);
    pose_of[keyframe.id.value] = i;
    problem.bundle.T_world_camera.push_back(keyframe.T_world_camera);
    problem.bundle.fixed.push_back(i >= free_keyframes || keyframe.id.value == 0 ? 1 : 0);
  }
  fix_gauge(problem, map);
  for (uint32_t point = 0; point < landmarks.size(); ++point) {
    problem.bundle.p_world.push_back(map.p_world(landmarks[point]));
    for (const Observation& seen : map.landmark(landmarks[point]).observations) {
      const uint32_t pose = pose_of[seen.keyframe.value];
      if (pose == kNone) continue;
      problem.bundle.observations.push_back({{}, pose, point});
      problem.observations.emplace_back(landmarks[point], seen);
    }
  }
  return problem;
}

/// Fills in the measurements and the sensor that they come from.
BundleAdjustmentProblem with_measurements(BundleAdjustmentProblem problem, const Map& map,
                                          const Sensor& sensor, MeasurementKind kind) {
  problem.bundle.sensor = kind == MeasurementKind::kRaw ? sensor : without_corrections(sensor);
  for (size_t i = 0; i < problem.observations.size(); ++i) {
    const Observation& seen = problem.observations[i].second;
    const Features& features = *map.keyframe(seen.keyframe).features;
    KeypointMeasurement& measured = problem.bundle.observations[i];
    measured = kind == MeasurementKind::kRaw ? raw_measurement(features, seen.feature, sensor.camera.height)
                                             : compensated_measurement(features, seen.feature);
  }
  return problem;
}

}  // namespace

std::vector<KeyframeId> oldest_tied(const Map& map, std::span<const KeyframeId> keyframes) {
  constexpr int kMinTying = 6;  // landmarks; three hold a pose
  std::vector<uint32_t> members;
  for (const KeyframeId id : keyframes) members.push_back(id.value);
  std::sort(members.begin(), members.end());
  const auto index_of = [&](KeyframeId id) {
    return static_cast<uint32_t>(std::lower_bound(members.begin(), members.end(), id.value) -
                                 members.begin());
  };
  DisjointSets parts(members.size());
  for (uint32_t i = 0; i < members.size(); ++i) {
    for (const auto& [other, shared] : map.covisible_keyframes(KeyframeId{members[i]}, kMinTying)) {
      const uint32_t at = index_of(other);
      if (at < members.size() && members[at] == other.value) parts.join(i, at);
    }
  }
  std::vector<KeyframeId> oldest;
  for (const KeyframeId id : keyframes) oldest.push_back(KeyframeId{members[parts.find(index_of(id))]});
  return oldest;
}

BundleAdjustmentProblem make_local_ba_problem(const Map& map, KeyframeId newest, const Sensor& sensor,
                                              const MappingOptions& options) {
  constexpr int kMaxFixedKeyframes = 20;
  std::vector<KeyframeId> keyframes{newest};
  for (const auto& [neighbour, shared] : map.covisible_keyframes(newest, kMinCovisibleLandmarks)) {
    if (static_cast<int>(keyframes.size()) >= options.local_ba_keyframes) break;
    keyframes.push_back(neighbour);
  }
  const auto landmarks = confirmed_landmarks(map, keyframes);
  const size_t free_keyframes = keyframes.size();
  const auto fixed = observers_outside(map, keyframes, landmarks, kMaxFixedKeyframes);
  keyframes.insert(keyframes.end(), fixed.begin(), fixed.end());
  return with_measurements(make_problem(map, keyframes, free_keyframes, landmarks), map, sensor,
                           MeasurementKind::kMotionCompensated);
}

BundleAdjustmentProblem make_global_ba_problem(const Map& map, const Sensor& sensor,
                                               MeasurementKind measured) {
  std::vector<KeyframeId> keyframes;
  for (const Keyframe& keyframe : map.keyframes()) keyframes.push_back(keyframe.id);
  return with_measurements(
      make_problem(map, keyframes, keyframes.size(), confirmed_landmarks(map, keyframes)), map, sensor,
      measured);
}

MapUpdate make_map_update(const BundleAdjustmentProblem& problem, const BundleSolution& solution) {
  MapUpdate update;
  update.newest_keyframe = problem.newest_keyframe;
  update.epoch = problem.epoch;
  for (size_t i = 0; i < problem.keyframes.size(); ++i) {
    if (problem.bundle.fixed[i] == 0) {
      update.T_world_camera.emplace_back(problem.keyframes[i], solution.T_world_camera[i]);
    }
  }
  for (size_t i = 0; i < problem.landmarks.size(); ++i) {
    if (solution.point_used[i] != 0) update.p_world.emplace_back(problem.landmarks[i], solution.p_world[i]);
  }
  for (size_t i = 0; i < problem.observations.size(); ++i) {
    if (solution.outliers[i] != 0) update.outliers.push_back(problem.observations[i]);
  }
  return update;
}

MapUpdate run_bundle_adjustment(const BundleAdjustmentProblem& problem, const BundleOptions& options) {
  return make_map_update(problem, solve_bundle(problem.bundle, options));
}

}  // namespace kinloop
