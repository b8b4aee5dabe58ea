#include "kinloop/loop/verification/join_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loop/joined_visits.hpp"

namespace kinloop {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

class Join : public testing::Test {
 protected:
  /// Compares the views that are new.
  std::vector<ViewPairResult> look() {
    std::vector<ViewPairResult> results;
    for (const OverlappingViews& views : joins_.take_views(visits_.map))
      results.push_back(compare_joined(views, visits_.sensor));
    return results;
  }

  std::vector<LoopEnds> find_contradicted(int min_views = 4) {
    joins_.add(look());
    return joins_.take_contradicted(visits_.map, min_views);
  }

  test::JoinedVisits visits_;
  JoinCheck joins_;
};

TEST_F(Join, OfOneRoomStays) {
  visits_.revisit(0, 6, false);
  EXPECT_THAT(look(), SizeIs(6));
  EXPECT_THAT(find_contradicted(), IsEmpty());
}

TEST_F(Join, IsRefutedByViewsThatComeLater) {
  visits_.revisit(0, 4, false);
  EXPECT_THAT(find_contradicted(), IsEmpty());
  visits_.revisit(4, true);
  EXPECT_THAT(find_contradicted(), IsEmpty()) << "one of five";
  visits_.revisit(5, true);
  EXPECT_THAT(find_contradicted(), ElementsAre(visits_.loop));
}

TEST_F(Join, ComparesEachKeyframeOnce) {
  EXPECT_FALSE(joins_.has_views(visits_.map)) << "nothing is joined";
  visits_.revisit(0, true);
  EXPECT_TRUE(joins_.has_views(visits_.map));
  EXPECT_THAT(look(), SizeIs(1));
  EXPECT_FALSE(joins_.has_views(visits_.map));
  EXPECT_THAT(look(), IsEmpty());
}

TEST_F(Join, IsNotJudgedByTooFewViews) {
  visits_.revisit(0, 6, true);
  EXPECT_THAT(find_contradicted(7), IsEmpty());
  EXPECT_THAT(find_contradicted(6), SizeIs(1));
}

TEST_F(Join, ViewsFarFromTheLoopHaveNoSay) {
  visits_.revisit(0, false);
  visits_.revisit(9, 12, true);
  EXPECT_THAT(look(), SizeIs(1));
}

TEST_F(Join, WithdrawnKeyframesHaveNoSay) {
  visits_.revisit(0, 3, false);
  visits_.map.withdraw(visits_.map.keyframes().back().id);
  EXPECT_THAT(look(), SizeIs(2));
}

TEST_F(Join, KeyframesOfLoadedMapsHaveNoSay) {
  visits_.revisit(0, 3, false);
  visits_.map.set_surfaces(visits_.map.keyframes().back().id, nullptr);
  EXPECT_THAT(look(), SizeIs(2)) << "people may be in its view";
}

TEST_F(Join, BeginsAnewOnceItsLoopsAreWithdrawn) {
  visits_.revisit(0, 6, true);
  const auto contradicted = find_contradicted();
  ASSERT_THAT(contradicted, SizeIs(1));
  visits_.map.withdraw_loops(contradicted, LoopReason::kAppearance);
  EXPECT_FALSE(joins_.has_views(visits_.map));
  EXPECT_THAT(find_contradicted(0), IsEmpty());
  LoopClosure again{visits_.loop.a, visits_.loop.b, SE3{}};
  again.stage = LoopStage::kVerified;
  visits_.map.add_loop_closure(again);
  EXPECT_THAT(look(), SizeIs(6));
}

}  // namespace
}  // namespace kinloop
