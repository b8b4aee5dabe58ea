#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/back_end/jobs/loop_jobs.hpp"
#include "tests/loop/joined_visits.hpp"

namespace kinloop {
namespace {

class JoinCheckJobTest : public testing::Test {
 protected:
  AppliedSolution run() {
    const FrameLog log;
    const JobContext context{visits_.map, log, visits_.sensor, {}};
    EXPECT_TRUE(job_.is_due(context));
    const auto applied = job_.apply(visits_.map, JoinCheckJob::solve(job_.make_problem(context)));
    EXPECT_FALSE(job_.is_due(context));
    return *applied;
  }

  [[nodiscard]] uint32_t component(uint32_t keyframe) const {
    return visits_.map.keyframe(KeyframeId{keyframe}).component;
  }

  test::JoinedVisits visits_;
  JoinCheckJob job_{BackEndOptions{}};
};

TEST_F(JoinCheckJobTest, LeavesATrueJoin) {
  visits_.revisit(0, 9, false);
  const uint32_t epoch = visits_.map.epoch();
  EXPECT_FALSE(run().map_changed);
  EXPECT_FALSE(job_.finish(visits_.map).map_changed);
  EXPECT_EQ(visits_.map.epoch(), epoch);
  EXPECT_THAT(visits_.map.loop_closures(), testing::SizeIs(1));
}

TEST_F(JoinCheckJobTest, PartsFloorsWhosePicturesDiffer) {
  visits_.revisit(0, 5, false);
  EXPECT_FALSE(run().map_changed);
  visits_.revisit(5, 8, true);
  EXPECT_FALSE(run().map_changed) << "too few views during the run";
  const uint32_t epoch = visits_.map.epoch();
  const AppliedSolution parted = job_.finish(visits_.map);
  EXPECT_TRUE(parted.map_changed);
  EXPECT_TRUE(parted.loops_corrected) << "the visits are adjusted without the join";
  EXPECT_THAT(parted.contradicted_joins, testing::ElementsAre(visits_.loop));
  EXPECT_THAT(parted.T_world_keyframe_before, testing::SizeIs(visits_.map.keyframes().size()));
  EXPECT_GT(visits_.map.epoch(), epoch) << "work in flight is stale";
  EXPECT_THAT(visits_.map.loop_closures(), testing::IsEmpty());
  ASSERT_THAT(visits_.map.other_loops(), testing::SizeIs(1));
  EXPECT_EQ(visits_.map.other_loops()[0].reason, LoopReason::kAppearance);
  EXPECT_NE(component(0), component(test::JoinedVisits::kPerVisit));
  visits_.map.check_invariants();
}

TEST_F(JoinCheckJobTest, PartsThemDuringTheRunWithEnoughViews) {
  visits_.revisit(0, 9, true);
  EXPECT_FALSE(run().map_changed);
  visits_.revisit(8, true);
  EXPECT_TRUE(run().map_changed);
}

}  // namespace
}  // namespace kinloop
