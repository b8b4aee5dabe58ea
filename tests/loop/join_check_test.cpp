#include "kinloop/loop/join_check.hpp"

#include <memory>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/loop/wall_view.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

/// Two visits along a wall that faces the camera, from places 0.5 m apart, joined at the first keyframes of
/// both.
class Join : public testing::Test {
 protected:
  Join() {
    for (int i = 0; i < 6; ++i) add(0, i, false);
  }

  /// Adds the keyframe at place `index`; the pictures on its wall may be others.
  void add(uint32_t visit, int index, bool different) {
    Features features = *test::wall_view(2);
    if (different) features.descriptors.rowRange(0, features.descriptors.rows / 4) = 255;
    const auto number = static_cast<uint32_t>(map_.keyframes().size());
    const KeyframeId id = map_.add_keyframe(FrameId{number}, number, test::camera_at(0, {0.5 * index, 0, 0}),
                                            std::make_shared<const Features>(std::move(features)), visit);
    if (number > 6) map_.set_visit(id, 1);
  }

  /// Begins the second visit and joins it to the first.
  void begin_second(bool different) {
    add(1, 0, different);
    LoopClosure loop{KeyframeId{0}, KeyframeId{6}, SE3{}};
    loop.stage = LoopStage::kVerified;
    map_.add_loop_closure(loop);
  }

  std::vector<LoopEnds> find_refuted(int min_views = 4) {
    return joins_.find_refuted(map_, sensor_, min_views);
  }

  Map map_;
  JoinCheck joins_;
  const Sensor sensor_{PinholeCamera{640, 480, 525, 525, 319.5, 239.5, {}}};
};

TEST_F(Join, OfOneRoomStays) {
  begin_second(false);
  for (int i = 1; i < 6; ++i) add(0, i, false);
  EXPECT_THAT(find_refuted(), testing::IsEmpty());
}

TEST_F(Join, IsRefutedByViewsThatComeLater) {
  begin_second(false);
  for (int i = 1; i < 4; ++i) add(0, i, false);
  EXPECT_THAT(find_refuted(), testing::IsEmpty());
  add(0, 4, true);
  EXPECT_THAT(find_refuted(), testing::IsEmpty()) << "one of five";
  add(0, 5, true);
  EXPECT_THAT(find_refuted(), testing::ElementsAre(LoopEnds{KeyframeId{0}, KeyframeId{6}}));
}

TEST_F(Join, ComparesEachKeyframeOnce) {
  begin_second(true);
  for (int i = 0; i < 8; ++i) EXPECT_THAT(find_refuted(2), testing::IsEmpty());
}

TEST_F(Join, IsNotJudgedByTooFewViews) {
  begin_second(true);
  for (int i = 1; i < 6; ++i) add(0, i, true);
  EXPECT_THAT(find_refuted(7), testing::IsEmpty());
  EXPECT_THAT(find_refuted(6), testing::SizeIs(1));
}

TEST_F(Join, ViewsFarFromTheLoopHaveNoSay) {
  begin_second(false);
  for (int i = 12; i < 24; ++i) {
    add(0, i, false);
    map_.set_visit(KeyframeId{static_cast<uint32_t>(map_.keyframes().size() - 1)}, 0);
    add(0, i, true);
  }
  EXPECT_THAT(find_refuted(), testing::IsEmpty());
}

TEST_F(Join, IsForgottenOnceItsLoopsAreWithdrawn) {
  begin_second(true);
  for (int i = 1; i < 6; ++i) add(0, i, true);
  const auto refuted = find_refuted();
  map_.withdraw_loops(refuted, LoopReason::kDoesNotFit);
  EXPECT_THAT(find_refuted(), testing::IsEmpty());
}

}  // namespace
}  // namespace kinloop
