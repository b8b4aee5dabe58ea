// Laws of the map that hold after any sequence of verbs.

#include <map>
#include <optional>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/random_map.hpp"

namespace kinloop {
namespace {

using test::difference;
using test::MapVerb;
using test::RandomMap;

constexpr uint64_t kSeeds = 5;
constexpr double kRounding = 1e-9;  // poses pass through hundreds of products

/// Where everything is.
struct Places {
  explicit Places(const Map& map) {
    for (const Keyframe& keyframe : map.keyframes()) T_world_camera.push_back(keyframe.T_world_camera);
    for (const LandmarkId id : map.landmark_ids()) p_world[id] = map.p_world(id);
  }

  std::vector<SE3> T_world_camera;
  std::map<LandmarkId, Eigen::Vector3d> p_world;
};

void expect_equal(const MapData& a, const MapData& b) {
  ASSERT_EQ(a.keyframes.size(), b.keyframes.size());
  for (size_t i = 0; i < a.keyframes.size(); ++i) {
    const Keyframe &x = a.keyframes[i], &y = b.keyframes[i];
    EXPECT_EQ(
        std::tie(x.id, x.frame, x.stamp_ns, x.component, x.begins_component, x.features, x.landmark_of),
        std::tie(y.id, y.frame, y.stamp_ns, y.component, y.begins_component, y.features, y.landmark_of));
    EXPECT_EQ(x.T_world_camera.matrix(), y.T_world_camera.matrix());
  }
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  for (size_t i = 0; i < a.landmarks.size(); ++i) {
    ASSERT_EQ(a.landmarks[i].has_value(), b.landmarks[i].has_value());
    if (!a.landmarks[i]) continue;
    const Landmark &x = *a.landmarks[i], &y = *b.landmarks[i];
    EXPECT_EQ(std::tie(x.id, x.anchor, x.p_anchor, x.observations),
              std::tie(y.id, y.anchor, y.p_anchor, y.observations));
  }
  ASSERT_EQ(a.loop_closures.size(), b.loop_closures.size());
  for (size_t i = 0; i < a.loop_closures.size(); ++i) {
    EXPECT_EQ(std::tie(a.loop_closures[i].a, a.loop_closures[i].b, a.loop_closures[i].evidence.inliers),
              std::tie(b.loop_closures[i].a, b.loop_closures[i].b, b.loop_closures[i].evidence.inliers));
    EXPECT_EQ(a.loop_closures[i].T_a_b.matrix(), b.loop_closures[i].T_a_b.matrix());
  }
  EXPECT_EQ(a.component_count, b.component_count);
}

size_t components(const Map& map) {
  std::set<uint32_t> found;
  for (const Keyframe& keyframe : map.keyframes()) found.insert(keyframe.component);
  return found.size();
}

TEST(MapLaws, EveryVerbKeepsTheInvariantsAndMovesOnlyWhatItShould) {
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomMap random(seed);
    const Map& map = random.map();
    std::map<MapVerb, int> used;
    for (int step = 0; step < 800; ++step) {
      const Places before(map);
      const MapVerb verb = random.step();
      ++used[verb];
      ASSERT_NO_THROW(map.check_invariants()) << "seed " << seed << ", step " << step;
      const Places after(map);
      EXPECT_EQ(after.p_world.size(), map.landmark_count());
      if (verb == MapVerb::kUpdate || verb == MapVerb::kLoopClosure) continue;
      for (size_t i = 0; i < before.T_world_camera.size(); ++i)
        ASSERT_EQ(before.T_world_camera[i].matrix(), after.T_world_camera[i].matrix());
      for (const auto& [id, point] : before.p_world) {
        if (!map.contains(id)) continue;
        ASSERT_LT((after.p_world.at(id) - point).norm(), kRounding) << "seed " << seed;
      }
    }
    EXPECT_EQ(used.size(), 7U) << "a verb was never tried";
    EXPECT_GT(components(map), 1U);
  }
}

/// The keyframe that a keyframe newer than the problem follows: the last one of its component up to `newest`.
std::optional<size_t> leader_of(const Map& map, size_t keyframe, KeyframeId newest) {
  std::optional<size_t> leader;
  for (size_t i = 0; i <= newest.value; ++i) {
    if (map.keyframes()[i].component == map.keyframes()[keyframe].component) leader = i;
  }
  return leader;
}

TEST(MapLaws, AnUpdateMovesItsKeyframesAndWhatFollowsThem) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    RandomMap random(seed);
    Map& map = random.grow(300).map();
    const Places before(map);
    const MapUpdate update = random.random_update();
    std::map<LandmarkId, KeyframeId> anchors;
    for (const LandmarkId id : map.landmark_ids()) anchors[id] = map.landmark(id).anchor;
    ASSERT_TRUE(map.apply(update));
    std::map<size_t, SE3> corrected;
    for (const auto& [id, T] : update.T_world_camera) corrected[id.value] = T;
    for (size_t i = 0; i < before.T_world_camera.size(); ++i) {
      SE3 expected = before.T_world_camera[i];
      if (i <= update.newest_keyframe.value) {
        if (corrected.contains(i)) expected = corrected[i];
      } else if (const auto leader = leader_of(map, i, update.newest_keyframe); leader) {
        const SE3 T_leader =
            corrected.contains(*leader) ? corrected[*leader] : before.T_world_camera[*leader];
        expected = T_leader * before.T_world_camera[*leader].inverse() * expected;
      }
      EXPECT_LT(difference(map.keyframes()[i].T_world_camera, expected), kRounding) << "keyframe " << i;
    }
    std::map<LandmarkId, Eigen::Vector3d> given(update.p_world.begin(), update.p_world.end());
    for (const auto& [id, point] : before.p_world) {
      const size_t anchor = anchors[id].value;
      const Eigen::Vector3d moved =
          map.keyframes()[anchor].T_world_camera * (before.T_world_camera[anchor].inverse() * point);
      const Eigen::Vector3d expected = given.contains(id) ? given[id] : moved;
      EXPECT_LT((map.p_world(id) - expected).norm(), kRounding);
    }
  }
}

TEST(MapLaws, AnUpdateThenItsInverseRestoresEverything) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    RandomMap random(seed);
    Map& map = random.grow(300).map();
    const Places before(map);
    const MapUpdate update = random.random_update();
    MapUpdate inverse = update;
    for (auto& [id, T] : inverse.T_world_camera) T = before.T_world_camera[id.value];
    for (auto& [id, point] : inverse.p_world) point = before.p_world.at(id);
    ASSERT_TRUE(map.apply(update));
    ASSERT_TRUE(map.apply(inverse));
    const Places after(map);
    for (size_t i = 0; i < before.T_world_camera.size(); ++i)
      EXPECT_LT(difference(before.T_world_camera[i], after.T_world_camera[i]), 1e-12);
    for (const auto& [id, point] : before.p_world) EXPECT_LT((after.p_world.at(id) - point).norm(), 1e-12);
  }
}

TEST(MapLaws, AStaleUpdateChangesNothing) {
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomMap random(seed);
    Map& map = random.grow(300).map();
    MapUpdate update = random.random_update();
    const auto ids = map.landmark_ids();
    update.merges = {{{}, {{ids[0], ids[1]}}}};
    update.outliers = {{ids[2], map.landmark(ids[2]).observations.front()}};
    map.advance_epoch();
    const MapData before = map.data();
    EXPECT_FALSE(map.apply(update));
    expect_equal(map.data(), before);
  }
}

TEST(MapLaws, AppendedToAnEmptyMapTheDataRestoreTheMap) {
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomMap random(seed);
    const Map& map = random.grow(500).map();
    Map restored;
    restored.append(map.data());
    restored.check_invariants();
    expect_equal(restored.data(), map.data());
    EXPECT_EQ(restored.landmark_count(), map.landmark_count());
  }
}

TEST(MapLaws, AnAppendedMapIsACopyBesideTheFirst) {
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomMap one(seed), other(seed + 100);
    Map& map = one.grow(200).map();
    const MapData first = map.data(), second = other.grow(300).map().data();
    map.append(second);
    const MapData both = map.data();
    const auto keyframes = static_cast<uint32_t>(first.keyframes.size());
    const auto landmarks = static_cast<uint32_t>(first.landmarks.size());
    EXPECT_EQ(both.component_count, first.component_count + second.component_count);
    for (const Keyframe& keyframe : second.keyframes) {
      const Keyframe& copy = both.keyframes[keyframes + keyframe.id.value];
      EXPECT_EQ(copy.component, first.component_count + keyframe.component);
      EXPECT_EQ(copy.T_world_camera.matrix(), keyframe.T_world_camera.matrix());
      for (size_t i = 0; i < keyframe.landmark_of.size(); ++i) {
        const LandmarkId id = keyframe.landmark_of[i];
        EXPECT_EQ(copy.landmark_of[i], id.valid() ? LandmarkId{id.value + landmarks} : LandmarkId{});
      }
    }
    for (const LandmarkId id : other.map().landmark_ids())
      EXPECT_EQ(map.p_world(LandmarkId{id.value + landmarks}), other.map().p_world(id));
    for (size_t i = 0; i < second.loop_closures.size(); ++i) {
      const LoopClosure& copy = both.loop_closures[first.loop_closures.size() + i];
      EXPECT_EQ(copy.a.value, second.loop_closures[i].a.value + keyframes);
      EXPECT_EQ(copy.b.value, second.loop_closures[i].b.value + keyframes);
    }
  }
}

TEST(MapLaws, MergedIdsResolveToWhatIsLeft) {
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomMap random(seed);
    Map& map = random.grow(400).map();
    const auto before = map.landmark_ids();
    std::map<LandmarkId, LandmarkId> now;  // by brute force: all that were merged so far
    for (const LandmarkId id : before) now[id] = id;
    for (int i = 0; i < 40 && map.landmark_count() > 2; ++i) {
      const LandmarkId from = random.landmark(), into = random.landmark();
      if (from == into) continue;
      std::set<KeyframeId> observers;
      for (const LandmarkId id : {from, into}) {
        for (const Observation& seen : map.landmark(id).observations) observers.insert(seen.keyframe);
      }
      map.merge(from, into);
      EXPECT_EQ(map.landmark(into).observations.size(), observers.size()) << "each observer once";
      for (auto& [id, resolved] : now) resolved = resolved == from ? into : resolved;
    }
    for (const LandmarkId id : before) EXPECT_EQ(map.resolve_merged(id), now[id]);
    EXPECT_LT(map.landmark_count(), before.size());
  }
}

TEST(MapLaws, MergesOfAnUpdateAreIdempotent) {
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomMap random(seed);
    Map& map = random.grow(400).map();
    MapUpdate update;
    LandmarkMerges& merges = update.merges.emplace_back().merges;
    for (int i = 0; i < 20; ++i) {
      const LandmarkId from = random.landmark(), into = random.landmark();
      merges.emplace_back(from, into);
    }
    update.epoch = map.epoch();
    ASSERT_TRUE(map.apply(update));
    map.check_invariants();
    const MapData once = map.data();
    ASSERT_TRUE(map.apply(update));
    expect_equal(map.data(), once);
  }
}

TEST(MapLaws, CovisibilityCountsSharedLandmarksInBothDirections) {
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomMap random(seed);
    const Map& map = random.grow(600).map();
    const auto landmarks_of = [&](const Keyframe& keyframe) {
      std::set<LandmarkId> ids(keyframe.landmark_of.begin(), keyframe.landmark_of.end());
      ids.erase(LandmarkId{});
      return ids;
    };
    Map restored;
    restored.append(map.data());
    for (const Keyframe& a : map.keyframes()) {
      std::map<KeyframeId, int> expected;
      for (const Keyframe& b : map.keyframes()) {
        int shared = 0;
        for (const LandmarkId id : landmarks_of(b)) shared += landmarks_of(a).contains(id) ? 1 : 0;
        if (a.id != b.id && shared > 0) expected[b.id] = shared;
      }
      const auto found = map.covisible_keyframes(a.id, 1);
      EXPECT_EQ((std::map<KeyframeId, int>(found.begin(), found.end())), expected);
      EXPECT_EQ(restored.covisible_keyframes(a.id, 1), found);
      for (size_t i = 1; i < found.size(); ++i) {
        EXPECT_TRUE(found[i - 1].second > found[i].second ||
                    (found[i - 1].second == found[i].second && found[i - 1].first < found[i].first));
      }
    }
  }
}

TEST(MapLaws, ALoopEdgeJoinsComponentsWithoutBendingThem) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    RandomMap random(seed);
    Map& map = random.grow(200).map();
    const Places before(map);
    const std::vector<Keyframe> old = map.keyframes();
    const size_t count = components(map);
    const uint32_t epoch = map.epoch();
    const KeyframeId a = random.keyframe(), b = random.keyframe();
    if (a == b) continue;
    const SE3 T_a_b = test::random_step(random.random(), 1, 0.5);
    map.add_loop_closure({a, b, T_a_b, Matrix6d::Identity(), {30, 40}, LoopStage::kVerified});
    map.check_invariants();
    const uint32_t older = std::min(old[a.value].component, old[b.value].component);
    const bool joined = old[a.value].component != old[b.value].component;
    EXPECT_EQ(components(map), joined ? count - 1 : count);
    EXPECT_EQ(map.epoch() != epoch, joined);
    if (joined) {
      const SE3 T_b = map.keyframe(a).T_world_camera * T_a_b;
      EXPECT_LT(difference(map.keyframe(b).T_world_camera, T_b), kRounding);
    }
    std::map<uint32_t, SE3> moved;  // how each former component has moved
    for (const Keyframe& was : old) {
      const Keyframe& is = map.keyframe(was.id);
      const SE3 motion = is.T_world_camera * was.T_world_camera.inverse();
      const SE3& expected = moved.try_emplace(was.component, motion).first->second;
      EXPECT_LT(difference(motion, expected), kRounding);
      if (is.component != was.component || was.component > older) continue;
      EXPECT_EQ(is.T_world_camera.matrix(), was.T_world_camera.matrix()) << "the older one stays";
    }
    for (const auto& [id, point] : before.p_world) {
      const uint32_t component = old[map.landmark(id).anchor.value].component;
      EXPECT_LT((map.p_world(id) - moved.at(component) * point).norm(), kRounding);
    }
  }
}

}  // namespace
}  // namespace kinloop
