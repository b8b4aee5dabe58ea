#include "kinloop/loop/recognition/candidates.hpp"

#include <gtest/gtest.h>

#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

/// Two visits of one place, two keyframes each; the second visit does not recognise the first.
class KnownPlaces : public testing::Test {
 protected:
  KnownPlaces() {
    for (int i = 0; i < 4; ++i) {
      if (i == 2) built_.landmark_of_point.clear();
      const auto view = test::observe(world_, test::pose_on_arc(i % 2), {}, 10 + static_cast<uint64_t>(i));
      test::add_view(built_, world_, view, test::pose_on_arc(i % 2));
    }
  }

  [[nodiscard]] bool share_landmarks(int min_landmarks) const {
    return KnownPlace(built_.map, now_).shares_landmarks_with(before_, min_landmarks);
  }

  void add_loop(KeyframeId a, KeyframeId b) {
    built_.map.add_loop_closure({a, b, {}, Matrix6d::Identity(), {40}, LoopStage::kVerified});
  }

  /// Merges `count` landmarks of the second visit into others of the first.
  void merge_landmarks(int count) {
    const auto& older = built_.map.keyframe(KeyframeId{0}).landmark_of;
    const auto& newer = built_.map.keyframe(KeyframeId{3}).landmark_of;
    for (size_t i = 0; count > 0; ++i) {
      if (!older[i].valid() || !newer[i].valid()) continue;
      built_.map.merge(newer[i], older[i]);
      --count;
    }
  }

  test::SyntheticWorld world_ = test::make_world(1000, 1);
  test::SyntheticMap built_;
  const std::vector<KeyframeId> before_{KeyframeId{0}, KeyframeId{1}}, now_{KeyframeId{2}, KeyframeId{3}};
};

TEST_F(KnownPlaces, GroupOfCovisibleKeyframes) {
  EXPECT_EQ(covisible_group(built_.map, KeyframeId{1}), before_);
  EXPECT_EQ(covisible_group(built_.map, KeyframeId{2}), now_);
}

TEST_F(KnownPlaces, UnrecognisedRevisitSharesNoLandmarks) {
  EXPECT_FALSE(share_landmarks(1));
}

TEST_F(KnownPlaces, EachSharedLandmarkCountsOnce) {
  merge_landmarks(20);
  EXPECT_TRUE(share_landmarks(20));
  EXPECT_FALSE(share_landmarks(21));
}

TEST_F(KnownPlaces, InliersOfLoopsCountBeforeTheirLandmarksAreMerged) {
  merge_landmarks(20);
  add_loop(KeyframeId{0}, KeyframeId{2});  // a neighbour of the query
  EXPECT_TRUE(share_landmarks(60));
  EXPECT_FALSE(share_landmarks(61));
}

TEST_F(KnownPlaces, LoopsWithinAPlaceDoNotCount) {
  add_loop(KeyframeId{2}, KeyframeId{3});
  EXPECT_FALSE(share_landmarks(1));
}

}  // namespace
}  // namespace kinloop
