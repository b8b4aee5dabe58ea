// False loops among true ones: which are withdrawn, and what remains of the map.

#include <algorithm>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "tests/support/random_map.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

using testing::IsEmpty;
using testing::UnorderedElementsAreArray;

constexpr int kPerRound = 20, kRounds = 3;
constexpr uint32_t kShared = 100;  // landmarks that successive keyframes share

SE3 true_pose(uint32_t i) {
  const double angle = 2 * std::numbers::pi / kPerRound * i;
  return test::camera_at(angle, {1.5 * std::sin(angle), 0, 1.5 * std::cos(angle)});
}

/// A camera that goes round and round with the drift of odometry.
class FalseLoops : public testing::Test {
 protected:
  FalseLoops() { walk(5); }

  /// Begins anew with another drift.
  void walk(uint64_t seed) {
    map_ = {};
    odometry_ = {};
    random_ = Random(seed);
    SE3 T_world_camera = true_pose(0);
    for (uint32_t i = 0; i < kPerRound * kRounds; ++i) {
      if (i > 0) {
        T_world_camera = T_world_camera * true_pose(i - 1).inverse() * true_pose(i) *
                         test::random_step(random_, 0.003, 0.001);
      }
      add_keyframe(T_world_camera, i);
    }
  }

  /// With depth of 2 m everywhere, and sharing landmarks with the one before.
  void add_keyframe(const SE3& T_world_camera, uint32_t i) {
    Features features;
    features.pixels.assign(2 * kShared, Eigen::Vector2f::Zero());
    features.depths_m.assign(2 * kShared, 2.0F);
    const KeyframeId id = map_.add_keyframe(FrameId{i}, i, T_world_camera,
                                            std::make_shared<const Features>(std::move(features)));
    for (uint32_t k = 0; k < kShared; ++k) {
      if (i > 0) map_.add_observation(map_.keyframe(KeyframeId{i - 1}).landmark_of[kShared + k], {id, k});
      map_.add_landmark(id, kShared + k, {0, 0, 2});
    }
  }

  void add_loop(uint32_t a, uint32_t b, const SE3& T_a_b) {
    map_.add_loop_closure(
        {KeyframeId{a}, KeyframeId{b}, T_a_b, edge_information(100, {}), {100}, LoopStage::kVerified});
  }
  LoopEnds add_true_loop(uint32_t a, uint32_t b) {
    add_loop(a, b, true_pose(a).inverse() * true_pose(b) * test::random_step(random_, 0.004, 0.002));
    return {KeyframeId{a}, KeyframeId{b}};
  }
  LoopEnds add_false_loop(uint32_t a, uint32_t b) {
    add_loop(a, b, test::random_step(random_, 1, 0.3));
    return {KeyframeId{a}, KeyframeId{b}};
  }

  /// All keyframes of the second and third round see those of the first.
  void add_true_loops(uint32_t step) {
    for (uint32_t i = kPerRound; i < kPerRound * kRounds; i += step) add_true_loop(i % kPerRound, i);
  }

  LoopCorrection correct() {
    odometry_.observe(map_, {});
    LoopCorrection correction = correct_loop(make_loop_correction_problem(map_, {}, odometry_, {}), {});
    map_.withdraw_loops(correction.withdrawn, LoopReason::kDoesNotFit);
    EXPECT_TRUE(map_.apply(correction.update));
    map_.mark_corrected(correction.loops);
    map_.check_invariants();
    return correction;
  }

  [[nodiscard]] double largest_error_m() const {
    double largest = 0;
    for (uint32_t i = 0; i < map_.keyframes().size(); ++i) {
      largest =
          std::max(largest, test::distance_m(map_.keyframe(KeyframeId{i}).T_world_camera, true_pose(i)));
    }
    return largest;
  }

  Random random_{5};
  Map map_;
  OdometryBeforeLoops odometry_;
};

TEST_F(FalseLoops, TrueLoopsAreKept) {
  add_true_loops(2);
  const double before_m = largest_error_m();
  EXPECT_THAT(correct().withdrawn, IsEmpty());
  EXPECT_LT(largest_error_m(), before_m / 2);
}

TEST_F(FalseLoops, AmongTrueOnesExactlyTheFalseAreRejected) {
  for (const uint32_t share : {10U, 30U, 50U}) {
    walk(share);
    SCOPED_TRACE(share);
    add_true_loops(2);
    const auto true_loops = static_cast<uint32_t>(map_.loop_closures().size());
    std::vector<LoopEnds> expected;
    for (uint32_t k = 0; k * (100 - share) < share * true_loops; ++k)
      expected.push_back(add_false_loop(k, k + kPerRound + 7));
    EXPECT_THAT(correct().withdrawn, UnorderedElementsAreArray(expected));
    EXPECT_EQ(map_.loop_closures().size(), true_loops);
    EXPECT_LT(largest_error_m(), 0.03);
    ASSERT_EQ(map_.other_loops().size(), expected.size());
    for (const LoopClosure& loop : map_.other_loops()) EXPECT_EQ(loop.stage, LoopStage::kRejected);
  }
}

TEST_F(FalseLoops, AFalseLoopThatHasBentTheMapIsTakenBack) {
  const LoopEnds bad{KeyframeId{3}, KeyframeId{33}};
  add_loop(3, 33, true_pose(3).inverse() * true_pose(33) * SE3{Eigen::Quaterniond::Identity(), {0.32, 0, 0}});
  EXPECT_THAT(correct().withdrawn, IsEmpty()) << "drift could explain it";
  EXPECT_GT(largest_error_m(), 0.1);
  add_true_loops(4);
  EXPECT_THAT(correct().withdrawn, testing::ElementsAre(bad));
  EXPECT_LT(largest_error_m(), 0.03);
  ASSERT_EQ(map_.other_loops().size(), 1U);
  EXPECT_EQ(map_.other_loops()[0].stage, LoopStage::kWithdrawn);
  EXPECT_EQ(map_.other_loops()[0].reason, LoopReason::kDoesNotFit);
}

TEST_F(FalseLoops, LandmarksOfARejectedLoopAreNotMerged) {
  add_true_loops(4);
  const LoopEnds bad = add_false_loop(3, 33);
  const LandmarkId one = map_.keyframe(bad.a).landmark_of[0], other = map_.keyframe(bad.b).landmark_of[0];
  odometry_.observe(map_, {});
  const LoopCorrection correction =
      correct_loop(make_loop_correction_problem(map_, {{bad, {{other, one}}}}, odometry_, {}), {});
  EXPECT_THAT(correction.update.merges, IsEmpty());
  ASSERT_EQ(correction.merges.size(), 1U) << "kept, in case that the correction is stale";
}

TEST_F(FalseLoops, OdometryIsThatBeforeTheMapWasBent) {
  odometry_.observe(map_, {});
  const auto before = odometry_.edges();
  MapUpdate bent;
  bent.epoch = map_.epoch();
  bent.T_world_camera = {{KeyframeId{30}, test::camera_at(0.2, {1, 1, 1})}};
  ASSERT_TRUE(map_.apply(bent));
  odometry_.observe(map_, {});
  ASSERT_EQ(odometry_.edges().size(), before.size());
  for (size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(odometry_.edges()[i].T_a_b.matrix(), before[i].T_a_b.matrix());
}

}  // namespace
}  // namespace kinloop
