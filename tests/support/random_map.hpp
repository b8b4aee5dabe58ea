#pragma once
// A map that random verbs have built and changed: laws hold in any order of them.

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "kinloop/core/random.hpp"
#include "kinloop/map/map.hpp"
#include "tests/support/random_vectors.hpp"

namespace kinloop::test {

/// A motion of about `size_m` and `angle_rad` along and about each axis.
inline SE3 random_step(Random& random, double size_m, double angle_rad) {
  Vector6d twist = gaussian_vector<6>(random);
  twist.head<3>() *= size_m;
  twist.tail<3>() *= angle_rad;
  return SE3::exp(twist);
}

/// Difference of two poses; 1 rad counts as 1 m.
inline double difference(const SE3& a, const SE3& b) {
  return (a.translation - b.translation).norm() + (a.inverse() * b).angle_rad();
}

/// What a verb did.
enum class MapVerb { kGrow, kShrink, kMerge, kUpdate, kStaleUpdate, kLoopClosure, kAppend };

class RandomMap {
 public:
  static constexpr uint32_t kKeypoints = 12, kMaxKeyframes = 24;

  explicit RandomMap(uint64_t seed) : random_(seed) {}

  [[nodiscard]] Map& map() { return map_; }
  [[nodiscard]] Random& random() { return random_; }

  /// Applies `count` random verbs.
  RandomMap& grow(int count) {
    for (int i = 0; i < count; ++i) step();
    return *this;
  }

  /// Applies one random verb.
  MapVerb step() {
    const uint32_t verb = random_.index(100);
    if (map_.keyframes().size() < 3 || verb < 6) return add_keyframe();
    if (verb < 30 || map_.landmark_count() < 2) return add_landmark();
    if (verb < 64) return add_observation();
    if (verb < 72) return remove_observation();
    if (verb < 76) return erase();
    if (verb < 84) return merge();
    if (verb < 90) return apply(random_update());
    if (verb < 94) return apply_stale();
    if (verb < 99) return add_loop_closure();
    return append();
  }

  [[nodiscard]] KeyframeId keyframe() {
    return KeyframeId{random_.index(static_cast<uint32_t>(map_.keyframes().size()))};
  }
  [[nodiscard]] LandmarkId landmark() {
    const auto ids = map_.landmark_ids();
    return ids[random_.index(static_cast<uint32_t>(ids.size()))];
  }
  [[nodiscard]] Observation observation() {
    const KeyframeId seen_from = keyframe();
    return {seen_from, random_.index(kKeypoints)};
  }

  /// Corrects about half of the keyframes up to a random one, and some landmarks.
  [[nodiscard]] MapUpdate random_update() {
    MapUpdate update;
    update.epoch = map_.epoch();
    update.newest_keyframe = keyframe();
    for (uint32_t i = 0; i <= update.newest_keyframe.value; ++i) {
      if (random_.uniform() < 0.5)
        update.T_world_camera.emplace_back(KeyframeId{i}, random_step(random_, 1, 0.5));
    }
    for (const LandmarkId id : map_.landmark_ids()) {
      if (random_.uniform() < 0.2) update.p_world.emplace_back(id, gaussian_vector<3>(random_));
    }
    return update;
  }

  MapVerb add_keyframe() {
    const bool begins = map_.keyframes().empty() || random_.uniform() < 0.2;
    const uint32_t component = begins ? map_.component_count() : map_.keyframe(keyframe()).component;
    const auto number = static_cast<uint32_t>(map_.keyframes().size());
    Features features;
    features.pixels.assign(kKeypoints, Eigen::Vector2f::Zero());
    map_.add_keyframe(FrameId{3 * number}, number * 1000, random_step(random_, 1, 0.5),
                      std::make_shared<const Features>(features), component);
    return MapVerb::kGrow;
  }
  MapVerb add_landmark() {
    const Observation seen = observation();
    if (!map_.keyframe(seen.keyframe).landmark_of[seen.feature].valid())
      map_.add_landmark(seen.keyframe, seen.feature, gaussian_vector<3>(random_));
    return MapVerb::kGrow;
  }
  MapVerb add_observation() {
    const LandmarkId id = landmark();
    map_.add_observation(id, observation());
    return MapVerb::kGrow;
  }
  MapVerb remove_observation() {
    const LandmarkId id = landmark();
    const auto& seen = map_.landmark(id).observations;
    map_.remove_observation(id, seen[random_.index(static_cast<uint32_t>(seen.size()))]);
    return MapVerb::kShrink;
  }
  MapVerb erase() {
    map_.erase(landmark());
    return MapVerb::kShrink;
  }
  MapVerb merge() {
    const LandmarkId from = landmark(), into = landmark();
    if (from != into) map_.merge(from, into);
    return MapVerb::kMerge;
  }
  MapVerb apply(const MapUpdate& update) {
    map_.apply(update);
    return MapVerb::kUpdate;
  }
  MapVerb apply_stale() {
    MapUpdate update = random_update();
    map_.advance_epoch();
    map_.apply(update);
    return MapVerb::kStaleUpdate;
  }
  MapVerb add_loop_closure() {
    const KeyframeId a = keyframe(), b = keyframe();
    if (a != b)
      map_.add_loop_closure(
          {a, b, random_step(random_, 1, 0.5), Matrix6d::Identity(), {30, 40}, LoopStage::kVerified});
    return MapVerb::kLoopClosure;
  }
  MapVerb append() {
    if (2 * map_.keyframes().size() <= kMaxKeyframes) map_.append(map_.data());
    return MapVerb::kAppend;
  }

 private:
  Map map_;
  Random random_;
};

}  // namespace kinloop::test
