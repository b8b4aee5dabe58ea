#include "kinloop/map/map.hpp"

#include <algorithm>

#include "kinloop/core/errors.hpp"

namespace kinloop {
void Map::append(MapData parts) {
  const auto first_keyframe = static_cast<uint32_t>(keyframes_.size());
  const auto first_landmark = static_cast<uint32_t>(landmarks_.size());
  const auto shifted = [=](KeyframeId id) { return KeyframeId{id.value + first_keyframe}; };
  for (Keyframe& keyframe : parts.keyframes) {
    require(keyframe.features != nullptr && keyframe.T_world_camera.is_finite(),
            "append: keyframe without features or with a non-finite pose");
    keyframe.id = KeyframeId{static_cast<uint32_t>(keyframes_.size())};
    keyframe.component += component_count_;
    keyframe.visit += component_count_;
    keyframe.landmark_of.assign(keyframe.features->size(), LandmarkId{});
    keyframes_.push_back(std::move(keyframe));
  }
  for (auto& landmark : parts.landmarks) {
    landmarks_.push_back(std::nullopt);
    if (!landmark) continue;
    landmark->id = LandmarkId{static_cast<uint32_t>(landmarks_.size() - 1)};
    landmark->anchor = shifted(landmark->anchor);
    for (Observation& seen : landmark->observations) {
      seen.keyframe = shifted(seen.keyframe);
      keyframe_ref(seen.keyframe).landmark_of.at(seen.feature) = landmark->id;
    }
    landmarks_.back() = std::move(landmark);
    ++landmark_count_;
  }
  for (LoopClosure& loop : parts.loop_closures) {
    loop.a = shifted(loop.a), loop.b = shifted(loop.b);
    loop_closures_.push_back(loop);
  }
  for (LoopClosure& loop : parts.other_loops) {
    loop.a = shifted(loop.a), loop.b = shifted(loop.b);
    record_loop(loop);
  }
  component_count_ += parts.component_count;
  check_appended(first_keyframe, first_landmark);
  for (size_t i = first_keyframe; i < keyframes_.size(); ++i) covisibility_.add_keyframe();
  for (size_t i = first_landmark; i < landmarks_.size(); ++i) {
    if (landmarks_[i]) covisibility_.add(landmarks_[i]->observations);
  }
  advance_epoch();  // work in flight does not include it
}

/// Throws if the parts are inconsistent.
void Map::check_appended(size_t first_keyframe, size_t first_landmark) const {
  for (size_t i = first_landmark; i < landmarks_.size(); ++i) {
    if (landmarks_[i]) check_landmark(*landmarks_[i]);
  }
  for (size_t i = first_keyframe; i < keyframes_.size(); ++i) {
    require(keyframes_[i].component < component_count_ && keyframes_[i].visit < component_count_,
            "append: component index out of range");
  }
  for (const LoopClosure& loop : loop_closures_) {
    require(contains(loop.a) && contains(loop.b), "append: loop closure refers to a missing keyframe");
    require(loop.stage == LoopStage::kAccepted, "append: loop closure that was not accepted");
  }
}

KeyframeId Map::add_keyframe(FrameId frame, int64_t stamp_ns, const SE3& T_world_camera,
                             std::shared_ptr<const Features> features, uint32_t component) {
  require(features != nullptr, "add_keyframe: a keyframe needs features");
  require(T_world_camera.is_finite(), "add_keyframe: the pose is not finite");
  require(component <= component_count_, "add_keyframe: no such component");
  const KeyframeId id{static_cast<uint32_t>(keyframes_.size())};
  const bool begins = component == component_count_;
  if (begins) ++component_count_;
  const auto latest = std::find_if(keyframes_.rbegin(), keyframes_.rend(),
                                   [&](const Keyframe& other) { return other.component == component; });
  const uint32_t visit = latest == keyframes_.rend() ? component : latest->visit;
  std::vector<LandmarkId> landmark_of(features->size());
  keyframes_.push_back({.id = id,
                        .frame = frame,
                        .stamp_ns = stamp_ns,
                        .component = component,
                        .visit = visit,
                        .begins_component = begins,
                        .T_world_camera = T_world_camera,
                        .features = std::move(features),
                        .landmark_of = std::move(landmark_of)});
  covisibility_.add_keyframe();
  return id;
}

LandmarkId Map::add_landmark(KeyframeId anchor, uint32_t feature, const Eigen::Vector3d& p_anchor) {
  require(p_anchor.allFinite(), "add_landmark: the point is not finite");
  Keyframe& keyframe = keyframe_ref(anchor);
  require(feature < keyframe.landmark_of.size(), "add_landmark: no such keypoint");
  require(!keyframe.landmark_of[feature].valid(), "add_landmark: the keypoint already observes a landmark");
  const LandmarkId id{static_cast<uint32_t>(landmarks_.size())};
  landmarks_.push_back(Landmark{id, anchor, p_anchor, {{anchor, feature}}});
  keyframe.landmark_of[feature] = id;
  ++landmark_count_;
  return id;
}

bool Map::add_observation(LandmarkId id, const Observation& observation) {
  Landmark& landmark = landmark_ref(id);
  Keyframe& keyframe = keyframe_ref(observation.keyframe);
  require(observation.feature < keyframe.landmark_of.size(), "add_observation: no such keypoint");
  if (keyframe.landmark_of[observation.feature].valid()) return false;
  const auto same_keyframe = [&](const Observation& other) { return other.keyframe == observation.keyframe; };
  if (std::any_of(landmark.observations.begin(), landmark.observations.end(), same_keyframe)) return false;
  covisibility_.add(observation.keyframe, landmark.observations);
  landmark.observations.push_back(observation);
  keyframe.landmark_of[observation.feature] = id;
  return true;
}

void Map::add_loop_closure(LoopClosure loop) {
  require(contains(loop.a) && contains(loop.b), "add_loop_closure: no such keyframe");
  require(loop.stage == LoopStage::kVerified, "add_loop_closure: not verified");
  require(!keyframe(loop.a).withdrawn && !keyframe(loop.b).withdrawn, "add_loop_closure: withdrawn keyframe");
  require(loop.T_a_b.is_finite(), "add_loop_closure: the pose is not finite");
  loop.stage = LoopStage::kAccepted;
  std::erase_if(other_loops_, [&](const LoopClosure& other) { return other.ends() == loop.ends(); });
  loop_closures_.push_back(loop);
  if (keyframe(loop.a).component != keyframe(loop.b).component) merge_components(loop);
}

void Map::record_loop(const LoopClosure& loop) {
  require(contains(loop.a) && contains(loop.b), "record_loop: no such keyframe");
  require(loop.stage == LoopStage::kProvisional || loop.stage == LoopStage::kRejected ||
              loop.stage == LoopStage::kWithdrawn,
          "record_loop: neither provisional nor contradicted");
  std::erase_if(other_loops_, [&](const LoopClosure& other) { return other.ends() == loop.ends(); });
  other_loops_.push_back(loop);
}

void Map::mark_corrected(std::span<const LoopEnds> loops) {
  for (LoopClosure& loop : loop_closures_) {
    if (std::find(loops.begin(), loops.end(), loop.ends()) != loops.end()) loop.corrected = true;
  }
}

void Map::merge_components(const LoopClosure& loop) {
  const Keyframe& a = keyframe(loop.a);
  const Keyframe& b = keyframe(loop.b);
  const SE3 T_a_to_b = b.T_world_camera * (a.T_world_camera * loop.T_a_b).inverse();  // of the component of a
  const bool keep_a = a.component < b.component;
  const uint32_t into = std::min(a.component, b.component);
  const uint32_t from = std::max(a.component, b.component);
  const SE3 correction = keep_a ? T_a_to_b.inverse() : T_a_to_b;
  for (Keyframe& moved : keyframes_) {
    if (moved.component != from) continue;
    moved.component = into;
    moved.T_world_camera = correction * moved.T_world_camera;
  }
  advance_epoch();  // work in flight still assumes two components
}

void Map::remove_observation(LandmarkId id, Observation observation) {
  Landmark& landmark = landmark_ref(id);
  const auto found = std::find(landmark.observations.begin(), landmark.observations.end(), observation);
  require(found != landmark.observations.end(), "remove_observation: no such observation");
  if (landmark.observations.size() == 1) return erase(id);
  landmark.observations.erase(found);
  covisibility_.remove(observation.keyframe, landmark.observations);
  keyframe_ref(observation.keyframe).landmark_of[observation.feature] = LandmarkId{};
  if (landmark.anchor == observation.keyframe) move_anchor(landmark);
}

void Map::move_anchor(Landmark& landmark) {
  const Eigen::Vector3d point = keyframe(landmark.anchor).T_world_camera * landmark.p_anchor;
  landmark.anchor = landmark.observations.front().keyframe;
  landmark.p_anchor = keyframe(landmark.anchor).T_world_camera.inverse() * point;
}

void Map::erase(LandmarkId id) {
  const auto& observations = landmark(id).observations;
  for (const auto& [observer, feature] : observations)
    keyframe_ref(observer).landmark_of[feature] = LandmarkId{};
  covisibility_.remove(observations);
  landmarks_[id.value].reset();
  --landmark_count_;
}

void Map::withdraw(KeyframeId id) {
  Keyframe& keyframe = keyframe_ref(id);
  for (uint32_t feature = 0; feature < keyframe.landmark_of.size(); ++feature) {
    const LandmarkId landmark = keyframe.landmark_of[feature];
    if (landmark.valid()) remove_observation(landmark, {id, feature});
  }
  const auto is_end = [&](const LoopClosure& loop) { return loop.a == id || loop.b == id; };
  std::erase_if(loop_closures_, is_end);
  std::erase_if(other_loops_, is_end);
  keyframe.component = keyframe.visit = component_count_++;
  keyframe.begins_component = keyframe.withdrawn = true;
  advance_epoch();  // work in flight still uses it
}

void Map::merge(LandmarkId from, LandmarkId into) {
  require(from != into, "merge: a landmark cannot be merged with itself");
  const auto observations = landmark(from).observations;
  require(contains(into), "merge: no such landmark");
  erase(from);
  for (const Observation& observation : observations) add_observation(into, observation);
  merged_into_[from] = {into, observations.front().keyframe};
}

bool Map::apply(const MapUpdate& update) {
  if (update.epoch != epoch_) return false;
  const std::vector<SE3> T_world_camera_before = keyframe_poses();
  for (const auto& [id, T_world_camera] : update.T_world_camera) {
    require(T_world_camera.is_finite(), "apply: a corrected pose is not finite");
    keyframe_ref(id).T_world_camera = T_world_camera;
  }
  if (contains(update.newest_keyframe))
    propagate_correction(update.newest_keyframe.value + 1, T_world_camera_before);
  for (const auto& [id, point] : update.p_world) {
    if (!contains(id) || !point.allFinite()) continue;
    Landmark& landmark = landmark_ref(id);
    landmark.p_anchor = keyframe(landmark.anchor).T_world_camera.inverse() * point;
  }
  for (const auto& [id, observation] : update.outliers) {
    if (contains(id) && keyframe(observation.keyframe).landmark_of[observation.feature] == id)
      remove_observation(id, observation);
  }
  for (const auto& [loop, merges] : update.merges) {
    for (const auto& [from, into] : merges) {
      if (from == into || !contains(from) || !contains(into)) continue;
      merged_by_loop_[loop].push_back({landmark(from), into, keyframes_.back().id});
      merge(from, into);
    }
  }
  return true;
}

/// Keyframes from `first` on follow the correction of the last earlier keyframe in their component.
void Map::propagate_correction(size_t first, const std::vector<SE3>& T_world_camera_before) {
  for (size_t i = first; i < keyframes_.size(); ++i) {
    size_t leader = first;
    while (leader > 0 && keyframes_[leader - 1].component != keyframes_[i].component) --leader;
    if (leader == 0) continue;  // its component is newer than the problem
    const SE3 correction =
        keyframes_[leader - 1].T_world_camera * T_world_camera_before[leader - 1].inverse();
    keyframes_[i].T_world_camera = correction * keyframes_[i].T_world_camera;
  }
}

void Map::set_features(KeyframeId id, std::shared_ptr<const Features> features) {
  Keyframe& keyframe = keyframe_ref(id);
  require(features != nullptr && features->size() == keyframe.features->size(),
          "set_features: number of keypoints changed");
  keyframe.features = std::move(features);
}

void Map::set_patches(KeyframeId id, KeypointPatches patches) {
  Keyframe& keyframe = keyframe_ref(id);
  require(patches.keypoints() == keyframe.features->size(), "set_patches: number of keypoints differs");
  keyframe.patches = std::make_shared<const KeypointPatches>(std::move(patches));
}

void Map::set_odometry(KeyframeId id, const OdometryStep& step) {
  keyframe_ref(id).odometry = step;
}

void Map::set_visit(KeyframeId id, uint32_t visit) {
  require(visit < component_count_, "set_visit: no such visit");
  keyframe_ref(id).visit = visit;
}

void Map::set_surfaces(KeyframeId id, std::shared_ptr<const SurfaceGrid> surfaces) {
  keyframe_ref(id).surfaces = std::move(surfaces);
}

bool Map::contains(LandmarkId id) const {
  return id.value < landmarks_.size() && landmarks_[id.value].has_value();
}

LandmarkId Map::resolve_merged(LandmarkId id) const {
  for (auto next = merged_into_.find(id); next != merged_into_.end(); next = merged_into_.find(id)) {
    id = next->second.into;
  }
  return id;
}

const Keyframe& Map::keyframe(KeyframeId id) const {
  require(contains(id), "keyframe: no such keyframe");
  return keyframes_[id.value];
}

const Landmark& Map::landmark(LandmarkId id) const {
  require(contains(id), "landmark: no such landmark");
  return *landmarks_[id.value];
}

Keyframe& Map::keyframe_ref(KeyframeId id) {
  require(contains(id), "no such keyframe");
  return keyframes_[id.value];
}

Landmark& Map::landmark_ref(LandmarkId id) {
  require(contains(id), "no such landmark");
  return *landmarks_[id.value];
}

std::vector<LandmarkId> Map::landmark_ids() const {
  std::vector<LandmarkId> ids;
  for (const auto& landmark : landmarks_) {
    if (landmark) ids.push_back(landmark->id);
  }
  return ids;
}

std::vector<SE3> Map::keyframe_poses() const {
  std::vector<SE3> T_world_keyframe;
  for (const Keyframe& keyframe : keyframes_) T_world_keyframe.push_back(keyframe.T_world_camera);
  return T_world_keyframe;
}

std::optional<KeyframeId> Map::predecessor(KeyframeId id) const {
  const Keyframe& of = keyframe(id);
  if (of.begins_component) return std::nullopt;
  for (uint32_t earlier = id.value; earlier-- > 0;) {
    if (keyframes_[earlier].visit == of.visit) return KeyframeId{earlier};
  }
  return std::nullopt;
}

Eigen::Vector3d Map::p_world(LandmarkId id) const {
  const Landmark& point = landmark(id);
  return keyframe(point.anchor).T_world_camera * point.p_anchor;
}

std::vector<std::pair<KeyframeId, int>> Map::covisible_keyframes(KeyframeId id, int min_shared) const {
  require(contains(id), "covisible_keyframes: no such keyframe");
  return covisibility_.neighbours(id, std::max(min_shared, 1));
}

void Map::check_invariants() const {
  size_t count = 0;
  for (const auto& landmark : landmarks_) {
    if (!landmark) continue;
    ++count;
    check_landmark(*landmark);
  }
  require(count == landmark_count_, "invariant: wrong landmark count");
  for (const Keyframe& keyframe : keyframes_) {
    require(keyframe.landmark_of.size() == keyframe.features->size(),
            "invariant: one landmark entry per keypoint");
    for (uint32_t i = 0; i < keyframe.landmark_of.size(); ++i) {
      const LandmarkId id = keyframe.landmark_of[i];
      if (!id.valid()) continue;
      const auto& seen = landmark(id).observations;
      require(std::find(seen.begin(), seen.end(), Observation{keyframe.id, i}) != seen.end(),
              "invariant: a landmark lacks the observation of a keyframe");
    }
  }
}

void Map::check_landmark(const Landmark& landmark) const {
  require(!landmark.observations.empty(), "invariant: a landmark without observations");
  bool anchor_sees_it = false;
  std::vector<KeyframeId> observers;
  for (const auto& [observer, feature] : landmark.observations) {
    require(keyframe(observer).landmark_of[feature] == landmark.id,
            "invariant: an observed keypoint refers to another landmark");
    anchor_sees_it = anchor_sees_it || observer == landmark.anchor;
    observers.push_back(observer);
  }
  std::sort(observers.begin(), observers.end());
  require(std::adjacent_find(observers.begin(), observers.end()) == observers.end(),
          "invariant: a keyframe observes a landmark twice");
  require(anchor_sees_it, "invariant: a landmark's anchor does not observe it");
}

}  // namespace kinloop
