#include "kinloop/map/local_map.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/random_map.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

constexpr double kExact = 1e-12;

/// Eight keyframes along an arc.
class LocalMapTest : public testing::Test {
 protected:
  LocalMapTest() {
    for (int i = 0; i < 8; ++i) {
      const auto view = test::observe(world_, test::pose_on_arc(i), {}, 10 + static_cast<uint64_t>(i));
      test::add_view(built_, world_, view, test::pose_on_arc(i));
    }
  }

  Map& map() { return built_.map; }
  [[nodiscard]] const SE3& pose(KeyframeId id) const { return built_.map.keyframe(id).T_world_camera; }

  /// Landmarks of the reference and of its covisible keyframes.
  [[nodiscard]] std::set<LandmarkId> expected_landmarks(KeyframeId reference) const {
    std::set<LandmarkId> ids;
    const auto add = [&](KeyframeId keyframe) {
      for (const LandmarkId id : built_.map.keyframe(keyframe).landmark_of) {
        if (id.valid()) ids.insert(id);
      }
    };
    add(reference);
    for (const auto& [id, shared] : built_.map.covisible_keyframes(reference, kMinCovisibleLandmarks))
      add(id);
    return ids;
  }

  test::SyntheticWorld world_ = test::make_world(2500, 1);
  test::SyntheticMap built_;
};

TEST_F(LocalMapTest, HoldsTheLandmarksOfCovisibleKeyframesOnce) {
  for (const Keyframe& keyframe : map().keyframes()) {
    const LocalMap local = make_local_map(map(), keyframe.id, {});
    EXPECT_EQ(std::set<LandmarkId>(local.ids.begin(), local.ids.end()), expected_landmarks(keyframe.id));
    EXPECT_EQ(local.index_of.size(), local.size());
    for (uint32_t i = 0; i < local.size(); ++i) EXPECT_EQ(local.index_of.at(local.ids[i]), i);
  }
}

TEST_F(LocalMapTest, IsConsistentWithTheMap) {
  const KeyframeId reference{3};
  const LocalMap local = make_local_map(map(), reference, {});
  EXPECT_EQ(local.reference, reference);
  EXPECT_EQ(local.features, map().keyframe(reference).features);
  ASSERT_FALSE(local.ids.empty());
  for (uint32_t i = 0; i < local.size(); ++i) {
    const LocalView& view = local.views[local.view_of[i]];
    const Keyframe& observer = map().keyframe(view.keyframe);
    const uint32_t feature = local.feature_of[i];
    const Eigen::Vector3d p_world = map().p_world(local.ids[i]);
    EXPECT_EQ(observer.landmark_of[feature], local.ids[i]);
    EXPECT_EQ(map().landmark(local.ids[i]).observations.back(), (Observation{view.keyframe, feature}));
    EXPECT_LT((pose(reference) * local.p_reference[i] - p_world).norm(), kExact);
    EXPECT_LT(
        test::difference(view.T_keyframe_reference, observer.T_world_camera.inverse() * pose(reference)),
        1e-7);  // of an angle from a quaternion near identity
    const Eigen::Vector3d towards = observer.T_world_camera.translation - p_world;
    EXPECT_NEAR(local.observed_distances_m[i], towards.norm(), kExact);
    EXPECT_LT((pose(reference).rotation * local.viewing_directions[i] - towards.normalized()).norm(), kExact);
    EXPECT_EQ(local.observed_levels[i], observer.features->levels[feature]);
    const cv::Mat& descriptors = observer.features->descriptors;
    EXPECT_TRUE(std::equal(descriptors.ptr(static_cast<int>(feature)),
                           descriptors.ptr(static_cast<int>(feature)) + kOrbBytes,
                           local.descriptors.ptr(static_cast<int>(i))));
  }
}

TEST_F(LocalMapTest, CountsMatchesOfKnownDepth) {
  LocalMap local = make_local_map(map(), KeyframeId{3}, {});
  std::vector<LandmarkMatch> matches;
  for (uint32_t i = 0; i < 10; ++i) matches.push_back({local.ids[i], i});
  matches.push_back({LandmarkId{1'000'000}, 10});  // of another part of the map
  local.has_depth.assign(local.size(), true);
  for (const uint32_t triangulated : {2, 7, 8}) local.has_depth[triangulated] = false;
  EXPECT_EQ(count_with_depth(matches, local), 7);
}

TEST_F(LocalMapTest, TriangulatedLandmarksNeedMoreKeyframesToBeConfirmed) {
  const LocalMap measured = make_local_map(map(), KeyframeId{3}, {});
  for (const Keyframe& keyframe : map().keyframes()) {
    Features without_depth = *keyframe.features;
    std::fill(without_depth.depths_m.begin(), without_depth.depths_m.end(), 0.0F);
    map().set_features(keyframe.id, std::make_shared<const Features>(std::move(without_depth)));
  }
  const LocalMap triangulated = make_local_map(map(), KeyframeId{3}, {});
  ASSERT_EQ(triangulated.ids, measured.ids);
  std::set<size_t> counts;
  for (uint32_t i = 0; i < measured.size(); ++i) {
    const size_t observations = map().landmark(measured.ids[i]).observations.size();
    EXPECT_EQ(measured.confirmed[i], observations >= 2);
    EXPECT_EQ(triangulated.confirmed[i], observations >= 4);
    counts.insert(observations);
  }
  EXPECT_TRUE(counts.contains(1) && counts.contains(3) && counts.contains(4));
}

TEST_F(LocalMapTest, LimitsKeepTheNearestKeyframes) {
  const LocalMap all = make_local_map(map(), KeyframeId{3}, {});
  const auto& own = map().keyframe(KeyframeId{3}).landmark_of;
  const auto own_count = static_cast<size_t>(
      std::count_if(own.begin(), own.end(), [](const LandmarkId id) { return id.valid(); }));
  for (const int max_landmarks : {100, 150, 100000}) {
    const LocalMap limited = make_local_map(map(), KeyframeId{3}, {20, max_landmarks});
    ASSERT_EQ(limited.size(), std::min(all.size(), static_cast<size_t>(max_landmarks)));
    EXPECT_TRUE(std::equal(limited.ids.begin(), limited.ids.end(), all.ids.begin()));
  }
  size_t before = own_count;
  for (const int max_keyframes : {1, 2, 4}) {
    const LocalMap limited = make_local_map(map(), KeyframeId{3}, {max_keyframes, 100000});
    EXPECT_TRUE(std::equal(limited.ids.begin(), limited.ids.end(), all.ids.begin()));
    EXPECT_GT(limited.size(), before) << "each neighbour adds landmarks";
    std::set<LandmarkId> expected(own.begin(), own.end());
    const auto covisible = map().covisible_keyframes(KeyframeId{3}, kMinCovisibleLandmarks);
    for (size_t i = 0; i < static_cast<size_t>(max_keyframes); ++i) {
      const auto& seen = map().keyframe(covisible[i].first).landmark_of;
      expected.insert(seen.begin(), seen.end());
    }
    expected.erase(LandmarkId{});
    EXPECT_EQ(limited.size(), expected.size());
    before = limited.size();
  }
}

TEST_F(LocalMapTest, LandmarksAreTheSameFromAnyReference) {
  const LocalMap one = make_local_map(map(), KeyframeId{2}, {});
  const LocalMap other = make_local_map(map(), KeyframeId{5}, {});
  int shared = 0;
  for (uint32_t i = 0; i < one.size(); ++i) {
    const auto found = other.index_of.find(one.ids[i]);
    if (found == other.index_of.end()) continue;
    ++shared;
    const Eigen::Vector3d a = pose(KeyframeId{2}) * one.p_reference[i];
    const Eigen::Vector3d b = pose(KeyframeId{5}) * other.p_reference[found->second];
    EXPECT_LT((a - b).norm(), kExact);
    EXPECT_NEAR(one.observed_distances_m[i], other.observed_distances_m[found->second], kExact);
  }
  EXPECT_GT(shared, 200);
}

TEST_F(LocalMapTest, DoesNotDependOnTheWorldFrame) {
  const LocalMap before = make_local_map(map(), KeyframeId{3}, {});
  test::move_world(map(), test::camera_at(1.1, {5, -3, 2}));
  const LocalMap after = make_local_map(map(), KeyframeId{3}, {});
  ASSERT_FALSE(before.ids.empty());
  ASSERT_EQ(after.ids, before.ids);
  for (uint32_t i = 0; i < after.size(); ++i) {
    EXPECT_LT((after.p_reference[i] - before.p_reference[i]).norm(), kExact);
    EXPECT_LT((after.viewing_directions[i] - before.viewing_directions[i]).norm(), kExact);
  }
}

/// Every landmark in view from less than 60 degrees beside its last observer, and no other.
TEST_F(LocalMapTest, ProjectsEveryLandmarkInView) {
  const LocalMap local = make_local_map(map(), KeyframeId{3}, {});
  const Features& features = *local.features;
  Random random(3);
  int in_view = 0, beside = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const SE3 T_reference_camera = test::random_step(random, 1.2, 0.7);
    const SE3 T_world_camera = pose(KeyframeId{3}) * T_reference_camera;
    for (uint32_t i = 0; i < local.size(); ++i) {
      const Eigen::Vector3d p_world = map().p_world(local.ids[i]);
      const Eigen::Vector3d p_camera = T_world_camera.inverse() * p_world;
      const Eigen::Vector3d to_camera = T_world_camera.translation - p_world;
      const Eigen::Vector3d to_observer = pose(local.views[local.view_of[i]].keyframe).translation - p_world;
      const double cosine = to_camera.normalized().dot(to_observer.normalized());
      const bool visible = p_camera.z() > 0 && world_.camera.contains(world_.camera.project(p_camera));
      const auto found = LandmarkProjector{local, features, world_.camera, T_reference_camera, 4}(i);
      ASSERT_EQ(found.has_value(), visible && cosine >= 0.5);
      beside += visible && cosine < 0.5 ? 1 : 0;
      if (!found) continue;
      ++in_view;
      EXPECT_LT((found->pixel - world_.camera.project(p_camera)).norm(), 1e-9);
      EXPECT_NEAR(found->depth_m, p_camera.z(), kExact);
      const double level = std::log(to_observer.norm() / to_camera.norm()) / std::log(features.scale_factor);
      const double nearest = std::clamp(std::round(level), 0.0, features.level_count - 1.0);
      EXPECT_EQ(found->level_low + 1, nearest) << "all were seen on level 0";
      EXPECT_EQ(found->level_high - 1, nearest);
      EXPECT_NEAR(found->radius_px, 4 * std::pow(features.scale_factor, nearest), 1e-9);
    }
  }
  EXPECT_GT(in_view, 2000);
  EXPECT_GT(beside, 20) << "the angle was not tested";
}

}  // namespace
}  // namespace kinloop
