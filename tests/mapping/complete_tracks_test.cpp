
#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "kinloop/mapping/landmark_creation.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

using test::camera_at;
using test::pose_on_arc;

constexpr int kFirstVisit = 4;
constexpr int kSecondVisit = 2;

/// Two visits of one place, connected only by `shared` landmarks, as directly after a loop closure.
class CompleteTracks : public ::testing::Test {
 protected:
  explicit CompleteTracks(size_t shared = 40) {
    for (int i = 0; i < kFirstVisit; ++i) visit(first_, pose_on_arc(i), 10 + static_cast<uint64_t>(i));
    test::SyntheticMap second;
    second.map = std::move(first_.map);
    for (const auto& [point, landmark] : first_.landmark_of_point) {
      if (second.landmark_of_point.size() < shared) second.landmark_of_point[point] = landmark;
    }
    for (int i = 0; i < kSecondVisit; ++i)
      visit(second, pose_on_arc(i) * camera_at(0.02, {0.02, 0, 0}), 20 + static_cast<uint64_t>(i));
    map_ = std::move(second.map);
  }

  void visit(test::SyntheticMap& built, const SE3& pose, uint64_t seed) {
    const auto view = test::observe(world_, pose, {0.1, 1e-4, 5, 0.1}, seed);
    test::add_view(built, world_, view, pose);
    points_of_.push_back(view.point_of);
  }

  /// Points represented by more than one landmark.
  [[nodiscard]] size_t doubles() const {
    std::map<uint32_t, std::set<LandmarkId>> landmarks_of;
    for (const Keyframe& keyframe : map_.keyframes()) {
      const auto& points = points_of_[keyframe.id.value];
      for (size_t i = 0; i < points.size(); ++i) {
        if (keyframe.landmark_of[i].valid()) landmarks_of[points[i]].insert(keyframe.landmark_of[i]);
      }
    }
    return static_cast<size_t>(std::count_if(landmarks_of.begin(), landmarks_of.end(),
                                             [](const auto& entry) { return entry.second.size() > 1; }));
  }

  /// Fraction of the observations whose landmark represents a different point.
  [[nodiscard]] double wrong_share() const {
    std::map<LandmarkId, uint32_t> point_of;
    size_t wrong = 0, all = 0;
    for (const Keyframe& keyframe : map_.keyframes()) {
      const auto& points = points_of_[keyframe.id.value];
      for (size_t i = 0; i < points.size(); ++i) {
        if (!keyframe.landmark_of[i].valid()) continue;
        ++all;
        wrong += point_of.try_emplace(keyframe.landmark_of[i], points[i]).first->second != points[i] ? 1 : 0;
      }
    }
    return static_cast<double>(wrong) / static_cast<double>(all);
  }

  test::SyntheticWorld world_ = test::make_world(2500, 1);
  test::SyntheticMap first_;
  Map map_;
  std::vector<std::vector<uint32_t>> points_of_;  // by keyframe, then keypoint
};

TEST_F(CompleteTracks, MergesTracksOfARevisitedPlace) {
  const size_t doubles_before = doubles();
  const size_t landmarks_before = map_.landmark_count();
  ASSERT_GT(doubles_before, 100U);
  ASSERT_EQ(wrong_share(), 0);
  complete_tracks(map_, world_.camera, {}, {});
  map_.check_invariants();
  EXPECT_LT(doubles(), doubles_before / 50);
  EXPECT_LT(map_.landmark_count(), landmarks_before);
  EXPECT_EQ(wrong_share(), 0);
}

/// The second visit has not been recognized.
class CompleteTracksOfUnlinkedVisits : public CompleteTracks {
 protected:
  CompleteTracksOfUnlinkedVisits() : CompleteTracks(0) {}
};

TEST_F(CompleteTracksOfUnlinkedVisits, AreMergedWhereTheirViewsAreSimilar) {
  const size_t doubles_before = doubles();
  ASSERT_GT(doubles_before, 100U);
  ASSERT_LT(map_.covisible_keyframes(KeyframeId{kFirstVisit}, 1).size(), size_t{kSecondVisit});
  complete_tracks(map_, world_.camera, {}, {});
  map_.check_invariants();
  EXPECT_LT(doubles(), doubles_before / 10);
  EXPECT_EQ(wrong_share(), 0);
}

TEST_F(CompleteTracksOfUnlinkedVisits, AreNotMergedWhereTheirPosesAreNotComparable) {
  MapData parts = map_.data();
  for (size_t i = kFirstVisit; i < parts.keyframes.size(); ++i) parts.keyframes[i].component = 1;
  parts.component_count = 2;
  Map apart;
  apart.append(parts);
  const size_t landmarks = apart.landmark_count();
  complete_tracks(apart, world_.camera, {}, {});
  EXPECT_EQ(apart.landmark_count(), landmarks);
}

TEST_F(CompleteTracks, ResolvesIdsOfMergedLandmarks) {
  const auto before = map_.landmark_ids();
  complete_tracks(map_, world_.camera, {}, {});
  size_t renamed = 0;
  for (const LandmarkId id : before) {
    EXPECT_TRUE(map_.contains(map_.resolve_merged(id)));
    renamed += map_.resolve_merged(id) != id ? 1 : 0;
  }
  EXPECT_GT(renamed, 0U);
  EXPECT_EQ(before.size() - renamed, map_.landmark_count());
}

TEST_F(CompleteTracks, IsIdempotent) {
  complete_tracks(map_, world_.camera, {}, {});
  const size_t landmarks = map_.landmark_count();
  complete_tracks(map_, world_.camera, {}, {});
  EXPECT_EQ(map_.landmark_count(), landmarks);
}

TEST_F(CompleteTracks, LandmarksSeenByTheSameKeyframeAreNotMerged) {
  // Two keypoints of one keyframe so close and similar that each landmark matches both.
  Features twins = *test::observe(world_, SE3{}, {}, 3).features;
  const auto a = static_cast<uint32_t>(std::distance(
      twins.depths_m.begin(),
      std::find_if(twins.depths_m.begin(), twins.depths_m.end(), [](float d) { return d > 0; })));
  const uint32_t b = a + 1;
  twins.pixels[b] = twins.pixels[a] + Eigen::Vector2f(1, 0);
  twins.depths_m[b] = twins.depths_m[a];
  twins.levels[b] = twins.levels[a];
  twins.descriptors.row(static_cast<int>(a)).copyTo(twins.descriptors.row(static_cast<int>(b)));
  // The other keyframe has lost one of the two, so that both landmarks match the keypoint that is left.
  Features single = twins;
  single.pixels[b] = {5, 5};
  single.descriptors = twins.descriptors.clone();
  single.descriptors.row(static_cast<int>(b)).setTo(0);
  Map map;
  map.add_keyframe(FrameId{0}, 0, SE3{}, std::make_shared<const Features>(twins));
  map.add_keyframe(FrameId{1}, 1, SE3{}, std::make_shared<const Features>(single));
  const auto point = [&](uint32_t i) {
    return world_.camera.unproject(twins.pixels[i].cast<double>(), static_cast<double>(twins.depths_m[i]));
  };
  const LandmarkId first = map.add_landmark(KeyframeId{0}, a, point(a));
  const LandmarkId second = map.add_landmark(KeyframeId{0}, b, point(b));
  map.add_observation(first, {KeyframeId{1}, a});
  for (uint32_t i = b + 1; i < twins.size(); ++i) {  // enough for the two to be covisible
    if (twins.depths_m[i] > 0)
      map.add_observation(map.add_landmark(KeyframeId{0}, i, point(i)), {KeyframeId{1}, i});
  }
  const auto twin_matches = find_unobserved_landmarks(
      map, KeyframeId{1}, make_local_map(map, KeyframeId{1}, {}), world_.camera, {});
  ASSERT_TRUE(std::any_of(twin_matches.begin(), twin_matches.end(), [&](const auto& match) {
    return match.landmark == second && match.feature == a;
  })) << "nothing to merge";
  complete_tracks(map, world_.camera, {}, {});
  EXPECT_TRUE(map.contains(first));
  EXPECT_TRUE(map.contains(second));
  map.check_invariants();
}

TEST(CompleteTracksOfAnEmptyMap, IsNothing) {
  Map map;
  complete_tracks(map, {}, {}, {});
  EXPECT_TRUE(map.keyframes().empty());
}

}  // namespace
}  // namespace kinloop
