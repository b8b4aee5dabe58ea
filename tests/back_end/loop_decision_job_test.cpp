#include <memory>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/back_end/jobs/loop_jobs.hpp"
#include "tests/loop/wall_view.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

using testing::Each;
using testing::Field;
using testing::IsEmpty;
using testing::SizeIs;

constexpr uint32_t kPerVisit = 6;

/// Two visits of a wall that faces the camera, 2 m away, from places 0.5 m apart.
class LoopDecision : public testing::Test {
 protected:
  void visit(uint32_t different_views = 0) {
    const uint32_t component = map_.component_count();
    for (uint32_t i = 0; i < kPerVisit; ++i) {
      Features features = *test::painted_wall_view(2);
      if (i < different_views) test::repaint(features);
      map_.add_keyframe(FrameId{kPerVisit * component + i}, 0, test::camera_at(0, {0.5 * i, 0, 0}),
                        std::make_shared<const Features>(std::move(features)), component);
    }
  }

  /// Adds the verified loop between the keyframes of both visits at place `i`.
  AppliedSolution add(uint32_t i) {
    LoopClosure loop{KeyframeId{i}, KeyframeId{kPerVisit + i}, SE3{}};
    loop.information = edge_information(100, {});
    loop.evidence = {100, 150, {1, 0.004}};
    loop.stage = LoopStage::kVerified;
    return job_.add(map_, {{{loop, {}}}});
  }

  [[nodiscard]] ComparedJoins compare() const {
    EXPECT_TRUE(job_.is_due(context_));
    return LoopDecisionJob::solve(job_.make_problem(context_));
  }

  Map map_;
  const FrameLog log_;
  const Sensor sensor_{PinholeCamera{640, 480, 525, 525, 319.5, 239.5, {}}};
  const JobContext context_{map_, log_, sensor_, {}};
  LoopDecisionJob job_{BackEndOptions{}, [](const Map& /*map*/, KeyframeId /*id*/) { return false; }};
};

TEST_F(LoopDecision, JoinsVisitsOnceTheirViewsHaveBeenCompared) {
  visit(), visit();
  for (const uint32_t i : {0U, 1U}) EXPECT_FALSE(add(i).loops_added);
  EXPECT_FALSE(job_.is_due(context_)) << "two keyframes are too few";
  EXPECT_FALSE(add(2).loops_added) << "their views must be compared before";
  EXPECT_THAT(map_.loop_closures(), IsEmpty());
  const auto joined = job_.apply(map_, compare());
  ASSERT_TRUE(joined);
  EXPECT_TRUE(joined->loops_added);
  EXPECT_THAT(joined->merges, SizeIs(3));
  EXPECT_THAT(map_.loop_closures(), SizeIs(3));
  EXPECT_FALSE(job_.is_due(context_));
}

TEST_F(LoopDecision, RejectsALoopToAnotherFloor) {
  visit(), visit(2);
  for (const uint32_t i : {3U, 4U, 5U}) add(i);
  const auto decided = job_.apply(map_, compare());
  ASSERT_TRUE(decided);
  EXPECT_FALSE(decided->map_changed);
  EXPECT_THAT(map_.loop_closures(), IsEmpty());
  EXPECT_THAT(map_.other_loops(), SizeIs(3));
  EXPECT_THAT(map_.other_loops(), Each(Field(&LoopClosure::reason, LoopReason::kAppearance)));
  EXPECT_FALSE(job_.is_due(context_));
}

TEST_F(LoopDecision, LoopsThatComeMeanwhileAreDecidedWithTheirGroup) {
  visit(), visit();
  for (const uint32_t i : {0U, 1U, 2U}) add(i);
  const ComparedJoins compared = compare();
  EXPECT_THAT(compared.rooms, SizeIs(1)) << "one for all that agree";
  EXPECT_FALSE(add(3).loops_added);
  const auto joined = job_.apply(map_, compared);
  ASSERT_TRUE(joined);
  EXPECT_TRUE(joined->loops_added);
  EXPECT_THAT(map_.loop_closures(), SizeIs(4));
}

TEST_F(LoopDecision, ComparesAgainIfTheWholeMapHasMovedMeanwhile) {
  visit(), visit();
  for (const uint32_t i : {0U, 1U, 2U}) add(i);
  ComparedJoins compared = compare();
  map_.advance_epoch();
  EXPECT_FALSE(job_.apply(map_, compared)) << "components may have been parted";
  job_.on_stale(std::move(compared));
  const auto joined = job_.apply(map_, compare());
  ASSERT_TRUE(joined);
  EXPECT_TRUE(joined->loops_added);
}

TEST_F(LoopDecision, LoopsOfKeyframesThatAreWithdrawnMeanwhileAreForgotten) {
  visit(), visit();
  for (const uint32_t i : {0U, 1U, 2U}) add(i);
  ComparedJoins compared = compare();
  map_.withdraw(KeyframeId{kPerVisit + 2});
  EXPECT_FALSE(job_.apply(map_, compared)) << "the map has changed";
  job_.on_stale(std::move(compared));
  const auto decided = job_.apply(map_, compare());
  ASSERT_TRUE(decided);
  EXPECT_FALSE(decided->loops_added) << "two keyframes are too few";
  EXPECT_FALSE(job_.is_due(context_));
  EXPECT_THAT(map_.loop_closures(), IsEmpty());
}

TEST_F(LoopDecision, AtTheEndTwoKeyframesAreEnough) {
  visit(), visit();
  for (const uint32_t i : {0U, 1U}) add(i);
  EXPECT_FALSE(job_.finish(map_).loops_added);
  const auto joined = job_.apply(map_, compare());
  ASSERT_TRUE(joined);
  EXPECT_TRUE(joined->loops_added);
  EXPECT_THAT(map_.loop_closures(), SizeIs(2));
}

}  // namespace
}  // namespace kinloop
