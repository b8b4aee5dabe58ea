// Which verified loops become edges of the map.

#include "kinloop/loop/hypotheses.hpp"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/core/time.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr uint32_t kPerVisit = 12;

std::shared_ptr<const Features> no_features() {
  static const auto kNone = std::make_shared<const Features>();
  return kNone;
}

/// Two visits of one corridor, each with a world frame of its own; keyframe i of both is at the same place.
class Hypotheses : public testing::Test {
 protected:
  Hypotheses() {
    for (const uint32_t visit : {0U, 1U}) {
      for (uint32_t i = 0; i < kPerVisit; ++i) {
        const SE3 T_world_corridor = visit == 0 ? SE3{} : test::camera_at(0.7, {5, 1, 2});
        map_.add_keyframe(FrameId{visit * kPerVisit + i}, 0, T_world_corridor * place(i), no_features(),
                          visit);
      }
    }
  }

  static SE3 place(uint32_t i) { return test::camera_at(0.05 * i, {0.2 * i, 0, 0.02 * i}); }

  static KeyframeId first(uint32_t i) { return KeyframeId{i}; }
  static KeyframeId second(uint32_t i) { return KeyframeId{kPerVisit + i}; }

  /// The loop between keyframe i of the second visit and j of the first, whose pose is wrong by `error`.
  static LoopVerificationResult loop(uint32_t j, uint32_t i, const SE3& error = {}) {
    LoopClosure closure{first(j), second(i), place(j).inverse() * place(i) * error};
    closure.information = edge_information(100, {});
    closure.evidence = {100, 150, {1, 0.004}};
    closure.stage = LoopStage::kVerified;
    return {closure, {}};
  }

  /// A loop as if the second visit were elsewhere in the corridor.
  static LoopVerificationResult elsewhere(uint32_t j, uint32_t i) {
    LoopVerificationResult result = loop(j, i);
    result.loop.T_a_b = place(j).inverse() * test::camera_at(0.1, {1.5, 0, 0}) * place(i);
    return result;
  }

  static std::vector<LoopReason> reasons(const std::vector<LoopClosure>& loops) {
    std::vector<LoopReason> all;
    for (const LoopClosure& loop : loops) all.push_back(loop.reason);
    return all;
  }

  LoopDecisions add(std::vector<LoopVerificationResult> verified) {
    return compare(hypotheses_, hypotheses_.add(map_, std::move(verified)));
  }
  /// The decisions, with those that wait for comparisons.
  LoopDecisions compare(LoopHypotheses& hypotheses, LoopDecisions decisions) const {
    while (hypotheses.needs_comparison()) {
      const LoopDecisions later =
          hypotheses.decide(map_, compare_rooms(hypotheses.join_problem(map_, sensor_)));
      decisions.accepted.insert(decisions.accepted.end(), later.accepted.begin(), later.accepted.end());
      decisions.others.insert(decisions.others.end(), later.others.begin(), later.others.end());
    }
    return decisions;
  }
  LoopHypotheses no_loops() {
    return LoopHypotheses([this](const Map& /*map*/, KeyframeId id) { return aliased_.contains(id); });
  }
  LoopDecisions finish() { return compare(hypotheses_, hypotheses_.finish(map_)); }

  Map map_;
  std::set<KeyframeId> aliased_;  // keyframes whose place has one
  LoopHypotheses hypotheses_ = no_loops();
  const Sensor sensor_{PinholeCamera{640, 480, 525, 525, 319.5, 239.5, {}}};
};

TEST_F(Hypotheses, ThreeKeyframesThatAgreeAreAccepted) {
  for (const uint32_t i : {2U, 3U}) {
    const LoopDecisions waits = add({loop(i - 1, i)});
    EXPECT_THAT(waits.accepted, IsEmpty());
    ASSERT_THAT(waits.others, SizeIs(1));
    EXPECT_EQ(waits.others[0].stage, LoopStage::kProvisional);
    EXPECT_EQ(waits.others[0].reason, LoopReason::kTooFewKeyframes);
    EXPECT_EQ(waits.others[0].support, static_cast<int>(i) - 1);
  }
  const LoopDecisions third = add({loop(4, 5)});
  ASSERT_THAT(third.accepted, SizeIs(3));
  EXPECT_THAT(third.others, IsEmpty());
  for (const LoopVerificationResult& accepted : third.accepted) {
    EXPECT_EQ(accepted.loop.support, 3);
    EXPECT_EQ(accepted.loop.reason, LoopReason::kKeyframesAgree);
    EXPECT_EQ(accepted.loop.stage, LoopStage::kVerified);
  }
  EXPECT_THAT(finish().accepted, IsEmpty()) << "each loop is accepted once";
}

TEST_F(Hypotheses, SeveralPlacesOfOneKeyframeCountOnce) {
  EXPECT_THAT(add({loop(1, 2), loop(2, 2), loop(3, 2)}).accepted, IsEmpty());
}

TEST_F(Hypotheses, AtTheEndTwoAreEnoughButNotOne) {
  add({loop(1, 2)});
  const LoopDecisions one = finish();
  EXPECT_THAT(one.accepted, IsEmpty());
  EXPECT_THAT(reasons(one.others), ElementsAre(LoopReason::kTooFewKeyframes));
  add({loop(1, 3)});
  EXPECT_THAT(finish().accepted, SizeIs(2));
}

TEST_F(Hypotheses, KeyframesThatDisagreeAreNotAccepted) {
  const SE3 step = SE3{Eigen::Quaterniond::Identity(), {0.4, 0, 0}};
  add({loop(1, 2)});
  add({loop(2, 3, step)});
  EXPECT_THAT(add({loop(3, 4, step * step)}).accepted, IsEmpty());
  EXPECT_THAT(finish().accepted, IsEmpty());
}

TEST_F(Hypotheses, RelationIsDecidedByTheCycle) {
  const auto relation = [&](double error_m) {
    return relate(map_, loop(1, 2).loop, loop(2, 3, {Eigen::Quaterniond::Identity(), {0, error_m, 0}}).loop);
  };
  EXPECT_EQ(relation(0), LoopRelation::kAgree);
  EXPECT_EQ(relation(0.03), LoopRelation::kAgree);
  EXPECT_EQ(relation(0.3), LoopRelation::kContradict);
  LoopClosure reverse = loop(2, 3).loop;
  std::swap(reverse.a, reverse.b);
  reverse.T_a_b = reverse.T_a_b.inverse();
  EXPECT_EQ(relate(map_, loop(1, 2).loop, reverse), LoopRelation::kAgree);
  const LoopClosure within{first(0), first(8), SE3{}, edge_information(100, {})};
  EXPECT_EQ(relate(map_, loop(1, 2).loop, within), LoopRelation::kUnknown);
}

TEST_F(Hypotheses, OfTwoPlacesNoneIsTakenUntilLaterKeyframesDecide) {
  for (const uint32_t i : {2U, 3U, 4U}) {
    const LoopDecisions torn = add({loop(i, i), elsewhere(i, i)});
    EXPECT_THAT(torn.accepted, IsEmpty()) << i;
    EXPECT_THAT(reasons(torn.others), ElementsAre(LoopReason::kAmbiguous, LoopReason::kAmbiguous));
  }
  EXPECT_THAT(finish().accepted, IsEmpty());
  EXPECT_THAT(add({loop(5, 5)}).accepted, IsEmpty());
  const LoopDecisions decided = add({loop(6, 6)});
  ASSERT_THAT(decided.accepted, SizeIs(5));
  for (const LoopVerificationResult& accepted : decided.accepted)
    EXPECT_EQ(accepted.loop.a.value, accepted.loop.b.value - kPerVisit);
  ASSERT_THAT(decided.others, SizeIs(3));
  for (const LoopClosure& rival : decided.others) {
    EXPECT_EQ(rival.stage, LoopStage::kRejected);
    EXPECT_EQ(rival.reason, LoopReason::kDoesNotFit);
  }
}

TEST_F(Hypotheses, VisitsOfAnotherScaleAreRejected) {
  const auto scaled = [](uint32_t i, double sigma) {
    LoopVerificationResult result = loop(i, i);
    result.loop.evidence.scale = {0.95, sigma};
    return result;
  };
  for (const uint32_t i : {2U, 3U}) add({scaled(i, 0.01)});
  const LoopDecisions contradicted = add({scaled(4, 0.01)});
  EXPECT_THAT(contradicted.accepted, IsEmpty());
  EXPECT_THAT(reasons(contradicted.others),
              ElementsAre(LoopReason::kScale, LoopReason::kScale, LoopReason::kScale));
  // The same from measurements that cannot tell.
  for (const uint32_t i : {5U, 6U}) add({scaled(i, 0.1)});
  EXPECT_THAT(add({scaled(7, 0.1)}).accepted, SizeIs(3));
}

/// The first visit is larger than the second, whichever of them looks for the other.
TEST_F(Hypotheses, ScalesOfBothDirectionsAreComparedInOne) {
  const auto scaled = [](uint32_t i, bool reverse) {
    LoopVerificationResult result = loop(i, i);
    result.loop.evidence.scale = {reverse ? 0.96 : 1 / 0.96, 0.004};
    if (reverse) {
      std::swap(result.loop.a, result.loop.b);
      result.loop.T_a_b = result.loop.T_a_b.inverse();
    }
    return result;
  };
  for (const uint32_t i : {2U, 3U, 4U}) {
    const LoopDecisions decided = add({scaled(i, i % 2 == 0)});
    EXPECT_THAT(decided.accepted, IsEmpty()) << i;
    const LoopReason expected = i == 4 ? LoopReason::kScale : LoopReason::kTooFewKeyframes;
    EXPECT_THAT(reasons(decided.others), testing::AllOf(testing::Not(IsEmpty()), testing::Each(expected)));
  }
}

TEST_F(Hypotheses, OneLoopIsEnoughWhereTheMapPredictsIt) {
  const auto within = [&](double error_m) {
    LoopClosure closure = loop(0, 0).loop;
    closure.a = first(0), closure.b = first(kPerVisit - 1);
    closure.T_a_b = place(0).inverse() * place(kPerVisit - 1);
    closure.T_a_b.translation.y() += error_m;
    return closure;
  };
  EXPECT_TRUE(fits_map(map_, within(0.09)));
  EXPECT_FALSE(fits_map(map_, within(0.11)));
  EXPECT_FALSE(fits_map(map_, loop(1, 1).loop)) << "the pose between components is unknown";
  EXPECT_THAT(add({{within(0.3), {}}}).accepted, IsEmpty());
  hypotheses_ = no_loops();
  const LoopDecisions alone = add({{within(0.05), {}}});
  ASSERT_THAT(alone.accepted, SizeIs(1));
  EXPECT_EQ(alone.accepted[0].loop.reason, LoopReason::kFitsMap);
}

TEST_F(Hypotheses, AliasedPlacesDoNotJoinVisits) {
  aliased_ = {first(2), first(3), second(4)};  // of either visit
  for (const uint32_t i : {2U, 3U, 4U}) add({loop(i, i)});
  for (const uint32_t i : {5U, 6U}) {
    const LoopDecisions waits = add({loop(i, i)});
    EXPECT_THAT(waits.accepted, IsEmpty()) << i;
    EXPECT_THAT(reasons(waits.others), ElementsAre(LoopReason::kAmbiguous));
  }
  EXPECT_THAT(add({loop(7, 7)}).accepted, SizeIs(6)) << "three show places that are not aliased";
}

/// A later keyframe shows that a place is aliased, after it was asked for the first time.
TEST_F(Hypotheses, APlaceThatTurnsOutToBeAliasedDoesNotJoinVisits) {
  for (const uint32_t i : {2U, 3U}) add({loop(i, i)});
  hypotheses_.add(map_, {loop(4, 4)});
  ASSERT_TRUE(hypotheses_.needs_comparison());
  aliased_ = {first(2), first(3), first(4)};
  const LoopDecisions waits =
      hypotheses_.decide(map_, compare_rooms(hypotheses_.join_problem(map_, sensor_)));
  EXPECT_THAT(waits.accepted, IsEmpty());
  EXPECT_THAT(reasons(waits.others), ElementsAre(LoopReason::kAmbiguous));
}

TEST_F(Hypotheses, WithinAVisitPlacesMayBeAliased) {
  aliased_ = {first(0), first(kPerVisit - 1)};
  LoopClosure closure = loop(0, 0).loop;
  closure.a = first(0), closure.b = first(kPerVisit - 1);
  closure.T_a_b = place(0).inverse() * place(kPerVisit - 1);
  EXPECT_THAT(add({{closure, {}}}).accepted, SizeIs(1)) << "the map tells them apart";
}

TEST_F(Hypotheses, AVisitIsNotJoinedWhereTheCameraCannotHaveMovedInTime) {
  for (const double lost_s : {1.0, 4.0}) {
    LoopHypotheses hypotheses = no_loops();
    hypotheses.add_beginning(second(0), {first(kPerVisit - 1), SE3{}, Velocity{}, to_ns(-lost_s)});
    for (const uint32_t i : {2U, 3U}) hypotheses.add(map_, {loop(i, i)});
    const LoopDecisions third = compare(hypotheses, hypotheses.add(map_, {loop(4, 4)}));
    if (lost_s > 2) {
      EXPECT_THAT(third.accepted, SizeIs(3)) << "it has walked back";
    } else {
      EXPECT_THAT(third.accepted, IsEmpty());
      EXPECT_THAT(reasons(third.others), testing::Each(LoopReason::kDoesNotFit));
      EXPECT_THAT(third.others, SizeIs(3));
    }
  }
}

TEST_F(Hypotheses, WhereAGroupWasRefutedTheNextWaitsForMoreViews) {
  hypotheses_.add_beginning(second(0), {first(0), SE3{}, Velocity{}, to_ns(-1.0)});
  for (const uint32_t i : {2U, 3U}) add({elsewhere(i, i)});
  EXPECT_THAT(reasons(add({elsewhere(4, 4)}).others),
              testing::AllOf(testing::Not(IsEmpty()), testing::Each(LoopReason::kDoesNotFit)));
  for (const uint32_t i : {5U, 6U, 7U, 8U}) {
    const LoopDecisions waits = add({loop(i, i)});
    EXPECT_THAT(waits.accepted, IsEmpty()) << i;
    EXPECT_THAT(reasons(waits.others), ElementsAre(LoopReason::kTooFewKeyframes));
  }
}

TEST_F(Hypotheses, WhereAJoinWasTakenBackTheNextWaitsForMoreViews) {
  hypotheses_.record_contradicted({{first(0), second(0)}});
  for (const uint32_t i : {2U, 3U, 4U}) {
    const LoopDecisions waits = add({loop(i, i)});
    EXPECT_THAT(waits.accepted, IsEmpty()) << i;
    EXPECT_THAT(reasons(waits.others), ElementsAre(LoopReason::kTooFewKeyframes));
  }
}

TEST_F(Hypotheses, LoopsOfWithdrawnKeyframesAreForgotten) {
  for (const uint32_t i : {2U, 3U}) add({loop(i, i)});
  map_.withdraw(second(2));
  EXPECT_THAT(add({loop(2, 2), loop(4, 4)}).accepted, IsEmpty());
  EXPECT_THAT(finish().accepted, SizeIs(2));
}

}  // namespace
}  // namespace kinloop
