// Loop closures that are taken back: what they had joined is parted again.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/map/map.hpp"
#include "tests/support/random_map.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

using testing::ElementsAre;

constexpr float kDepth_m = 1.5F;

std::shared_ptr<const Features> features_at(float depth_m) {
  Features features;
  features.pixels.assign(20, Eigen::Vector2f::Zero());
  features.depths_m.assign(20, depth_m);
  return std::make_shared<const Features>(std::move(features));
}

LoopClosure verified_loop(KeyframeId a, KeyframeId b, const SE3& T_a_b) {
  return {a, b, T_a_b, Matrix6d::Identity(), {50}, LoopStage::kVerified};
}

/// Two visits, joined by a loop; keyframe `later_` was made after that in the second.
class JoinedVisits : public testing::Test {
 protected:
  JoinedVisits() {
    for (const uint32_t visit : {0U, 1U}) {
      for (uint32_t i = 0; i < 3; ++i)
        map_.add_keyframe(FrameId{3 * visit + i}, 0, test::camera_at(0.1 * i, {0.2 * i, visit * 3.0, 0}),
                          features_at(kDepth_m), visit);
    }
    map_.add_loop_closure(verified_loop(old_, new_, test::camera_at(0.05, {0.1, 0, 0})));
    later_ = map_.add_keyframe(FrameId{6}, 0, map_.keyframe(new_).T_world_camera, features_at(kDepth_m));
    shared_ = map_.add_landmark(old_, 0, {0, 0, 2});
    map_.add_observation(shared_, {new_, 0});
    map_.add_observation(shared_, {later_, 0});
    own_ = map_.add_landmark(new_, 1, {0, 0, 2});
    map_.add_observation(own_, {later_, 1});
  }

  void withdraw(std::vector<LoopEnds> loops) {
    map_.withdraw_loops(loops, LoopReason::kDoesNotFit);
    map_.check_invariants();
  }

  [[nodiscard]] std::vector<uint32_t> components() const {
    std::vector<uint32_t> all;
    for (const Keyframe& keyframe : map_.keyframes()) all.push_back(keyframe.component);
    return all;
  }

  Map map_;
  const KeyframeId old_{1}, new_{4};
  KeyframeId later_;
  LandmarkId shared_, own_;
};

TEST_F(JoinedVisits, KeyframesKnowTheirVisit) {
  EXPECT_THAT(components(), ElementsAre(0, 0, 0, 0, 0, 0, 0));
  for (const Keyframe& keyframe : map_.keyframes())
    EXPECT_EQ(keyframe.visit, keyframe.id.value < 3 ? 0U : 1U);
  map_.set_visit(later_, 0);
  EXPECT_EQ(map_.keyframe(later_).visit, 0U);
  EXPECT_THROW(map_.set_visit(later_, 2), std::logic_error);
}

TEST_F(JoinedVisits, WithoutTheirLoopTheyArePartedWhereTheyAre) {
  const MapData before = map_.data();
  withdraw({{old_, new_}});
  EXPECT_THAT(components(), ElementsAre(0, 0, 0, 2, 2, 2, 2));
  EXPECT_EQ(map_.component_count(), 3U);
  EXPECT_TRUE(map_.keyframe(KeyframeId{3}).begins_component);
  for (const Keyframe& keyframe : map_.keyframes()) {
    EXPECT_EQ(keyframe.T_world_camera.matrix(), before.keyframes[keyframe.id.value].T_world_camera.matrix());
    EXPECT_EQ(keyframe.visit, before.keyframes[keyframe.id.value].visit);
  }
  EXPECT_TRUE(map_.loop_closures().empty());
  ASSERT_EQ(map_.other_loops().size(), 1U);
  EXPECT_EQ(map_.other_loops()[0].stage, LoopStage::kRejected) << "it had not bent the map";
}

TEST_F(JoinedVisits, ALoopThatHadCorrectedTheMapIsWithdrawn) {
  map_.mark_corrected(std::vector<LoopEnds>{{old_, new_}});
  withdraw({{old_, new_}});
  EXPECT_EQ(map_.other_loops()[0].stage, LoopStage::kWithdrawn);
  EXPECT_EQ(map_.other_loops()[0].reason, LoopReason::kDoesNotFit);
}

TEST_F(JoinedVisits, AnotherLoopBetweenThemHoldsThemTogether) {
  map_.add_loop_closure(verified_loop(KeyframeId{2}, KeyframeId{5}, SE3{}));
  withdraw({{old_, new_}});
  EXPECT_THAT(components(), ElementsAre(0, 0, 0, 0, 0, 0, 0));
  EXPECT_EQ(map_.landmark(shared_).observations.size(), 3U);
  withdraw({{KeyframeId{2}, KeyframeId{5}}});
  EXPECT_THAT(components(), ElementsAre(0, 0, 0, 2, 2, 2, 2));
}

TEST_F(JoinedVisits, SharedLandmarksAreSplitAtTheDepthThatEachHasMeasured) {
  const Eigen::Vector3d p_later =
      map_.keyframe(new_).T_world_camera.inverse() * map_.p_world(shared_);  // later_ is at the same pose
  withdraw({{old_, new_}});
  EXPECT_EQ(map_.landmark(shared_).observations, std::vector<Observation>({{old_, 0}}));
  const LandmarkId split = map_.keyframe(new_).landmark_of[0];
  ASSERT_TRUE(split.valid());
  EXPECT_NE(split, shared_);
  EXPECT_EQ(map_.keyframe(later_).landmark_of[0], split);
  EXPECT_EQ(map_.landmark(split).anchor, new_);
  EXPECT_LT((map_.landmark(split).p_anchor - p_later * (kDepth_m / p_later.z())).norm(), 1e-6);
  EXPECT_EQ(map_.landmark(own_).observations.size(), 2U) << "of one visit";
}

TEST_F(JoinedVisits, MergedIdsResolveToTheirOwnSide) {
  const LandmarkId of_old = map_.add_landmark(old_, 5, {0, 0, 2});
  const LandmarkId of_new = map_.add_landmark(new_, 5, {0, 0, 2});
  map_.merge(of_new, of_old);
  ASSERT_EQ(map_.resolve_merged(of_new), of_old);
  withdraw({{old_, new_}});
  EXPECT_EQ(map_.resolve_merged(of_new), map_.keyframe(new_).landmark_of[5]);
  EXPECT_EQ(map_.keyframe(old_).landmark_of[5], of_old);
}

TEST_F(JoinedVisits, FramesFollowTheirOwnVisit) {
  FrameLog log(4);
  const auto locate = [&](size_t i, KeyframeId reference, TrackingOutcome outcome) {
    log[i].outcome = outcome;
    log[i].reference = reference;
    log[i].T_reference_camera = test::camera_at(0.1, {0.1, 0.2, 0.3});
    log[i].matches = {{shared_, 0}, {own_, 1}};
  };
  locate(0, new_, TrackingOutcome::kTracked);
  log[0].keyframe = later_;
  locate(1, old_, TrackingOutcome::kTracked);  // joined, it saw the other visit
  locate(2, old_, TrackingOutcome::kRelocalized);
  locate(3, old_, TrackingOutcome::kTracked);
  std::vector<SE3> before;
  for (const Keyframe& keyframe : map_.keyframes()) before.push_back(keyframe.T_world_camera);
  const SE3 seen_at = log[1].world(map_);
  withdraw({{old_, new_}});
  MapUpdate apart;
  apart.epoch = map_.epoch();
  apart.T_world_camera = {{old_, test::camera_at(0.3, {9, 9, 9})}};
  ASSERT_TRUE(map_.apply(apart));
  const FrameLog own = rebased_after_split(log, map_, before);
  EXPECT_EQ(own[1].reference, later_);
  EXPECT_LT(test::difference(own[1].world(map_), seen_at), 1e-9);
  EXPECT_THAT(own[1].matches, testing::SizeIs(1)) << "the landmark of the other visit is dropped";
  EXPECT_EQ(own[1].matches[0].landmark, own_);
  for (const size_t i : {2U, 3U}) {
    EXPECT_EQ(own[i].reference, old_) << "relocalized, it is in the other visit";
    EXPECT_EQ(own[i].T_reference_camera.matrix(), log[i].T_reference_camera.matrix());
  }
}

/// A landmark seen at the beginning and, by a false loop, at the end of one visit.
TEST(LoopWithinAVisit, InterruptedTracksAreSplitUnlessAnotherLoopSpansThem) {
  for (const bool spanned : {false, true}) {
    Map map;
    for (uint32_t i = 0; i < 30; ++i)
      map.add_keyframe(FrameId{i}, 0, test::camera_at(0, {0.1 * i, 0, 0}), features_at(kDepth_m));
    const LandmarkId torn = map.add_landmark(KeyframeId{1}, 0, {0, 0, 2});
    for (const uint32_t i : {2U, 27U, 28U}) map.add_observation(torn, {KeyframeId{i}, 0});
    const LandmarkId tracked = map.add_landmark(KeyframeId{0}, 1, {0, 0, 2});
    for (uint32_t i = 3; i < 30; i += 3) map.add_observation(tracked, {KeyframeId{i}, 1});
    map.add_loop_closure(verified_loop(KeyframeId{2}, KeyframeId{27}, SE3{}));
    if (spanned) map.add_loop_closure(verified_loop(KeyframeId{1}, KeyframeId{28}, SE3{}));
    map.withdraw_loops(std::vector<LoopEnds>{{KeyframeId{2}, KeyframeId{27}}}, LoopReason::kDoesNotFit);
    map.check_invariants();
    EXPECT_EQ(map.landmark(torn).observations.size(), spanned ? 4U : 2U);
    EXPECT_EQ(map.keyframe(KeyframeId{28}).landmark_of[0] == torn, spanned);
    EXPECT_EQ(map.landmark(tracked).observations.size(), 10U);
    EXPECT_EQ(map.component_count(), 1U);
  }
}

/// What a loop merged is again what it was, with what the camera has seen of it since.
TEST(LoopWithinAVisit, MergedLandmarksAreAgainWhatTheyWere) {
  Map map;
  for (uint32_t i = 0; i < 30; ++i)
    map.add_keyframe(FrameId{i}, 0, test::camera_at(0.01 * i, {0.1 * i, 0, 0}), features_at(kDepth_m));
  const KeyframeId old{2}, newer{27}, later{29};
  const LandmarkId into = map.add_landmark(old, 0, {0, 0, 2});
  map.add_observation(into, {KeyframeId{3}, 0});
  const LandmarkId from = map.add_landmark(KeyframeId{26}, 0, {0.3, 0.2, 1.7});
  map.add_observation(from, {newer, 0});
  const Landmark before = map.landmark(from), other = map.landmark(into);
  map.add_loop_closure(verified_loop(old, newer, SE3{}));
  MapUpdate update;
  update.epoch = map.epoch();
  update.merges = {{{old, newer}, {{from, into}}}};
  update.newest_keyframe = KeyframeId{28};
  ASSERT_TRUE(map.apply(update));
  ASSERT_EQ(map.resolve_merged(from), into);
  const KeyframeId last =
      map.add_keyframe(FrameId{30}, 0, map.keyframe(later).T_world_camera, features_at(kDepth_m));
  map.add_observation(into, {last, 0});

  map.withdraw_loops(std::vector<LoopEnds>{{old, newer}}, LoopReason::kDoesNotFit);
  map.check_invariants();
  EXPECT_EQ(map.resolve_merged(from), from);
  EXPECT_EQ(map.landmark(into).observations, other.observations);
  EXPECT_EQ(map.landmark(from).anchor, before.anchor);
  EXPECT_EQ(map.landmark(from).p_anchor, before.p_anchor);
  EXPECT_THAT(map.landmark(from).observations,
              testing::UnorderedElementsAre(Observation{KeyframeId{26}, 0}, Observation{newer, 0},
                                            Observation{last, 0}));
}

TEST(LoopRecords, ALaterDecisionReplacesTheRecord) {
  Map map;
  const KeyframeId a = map.add_keyframe(FrameId{0}, 0, SE3{}, features_at(1));
  const KeyframeId b = map.add_keyframe(FrameId{1}, 1, SE3{}, features_at(1));
  LoopClosure loop = verified_loop(a, b, SE3{});
  EXPECT_THROW(map.record_loop(loop), std::logic_error) << "neither provisional nor contradicted";
  loop.stage = LoopStage::kProvisional;
  map.record_loop(loop);
  loop.stage = LoopStage::kRejected;
  map.record_loop(loop);
  ASSERT_EQ(map.other_loops().size(), 1U);
  EXPECT_EQ(map.other_loops()[0].stage, LoopStage::kRejected);
  map.add_loop_closure(verified_loop(a, b, SE3{}));
  EXPECT_TRUE(map.other_loops().empty());
  EXPECT_THROW(map.withdraw_loops(std::vector<LoopEnds>{{b, a}}, LoopReason::kScale), std::logic_error);
}

}  // namespace
}  // namespace kinloop
