#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "apps/run/summary/run_summary.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

/// Two keyframes, one second apart.
Map two_keyframes() {
  Map map;
  for (uint32_t i = 0; i < 2; ++i)
    map.add_keyframe(FrameId{i}, 1'000'000'000 * (i + 1), SE3{}, std::make_shared<const Features>(), 0);
  return map;
}

LoopClosure loop(LoopStage stage, LoopReason reason) {
  LoopClosure loop;
  loop.a = KeyframeId{0};
  loop.b = KeyframeId{1};
  loop.evidence.inliers = 42;
  loop.stage = stage;
  loop.reason = reason;
  loop.support = 2;
  return loop;
}

TEST(LoopsJson, TellsBothEndsAndTheEvidence) {
  LoopClosure closed = loop(LoopStage::kAccepted, LoopReason::kKeyframesAgree);
  closed.evidence.scale = {0.998, 0.002};
  const json expected = {{"stamp_a", "1.000000"},
                         {"stamp_b", "2.000000"},
                         {"inliers", 42},
                         {"support", 2},
                         {"scale", 0.998},
                         {"status", "accepted"},
                         {"reason", "keyframes agree"}};
  EXPECT_EQ(loops_json({closed}, two_keyframes()), json::array({expected}));
}

TEST(LoopsJson, AnUnknownScaleIsNull) {
  const json all = loops_json({loop(LoopStage::kProvisional, LoopReason::kAmbiguous)}, two_keyframes());
  EXPECT_TRUE(all[0]["scale"].is_null());
}

TEST(LoopsJson, NamesStagesAndReasonsAsDocumented) {
  using enum LoopStage;
  using enum LoopReason;
  const std::vector<LoopClosure> loops = {
      loop(kAccepted, kFitsMap),      loop(kAccepted, kLoaded), loop(kProvisional, kTooFewKeyframes),
      loop(kProvisional, kAmbiguous), loop(kRejected, kScale),  loop(kWithdrawn, kDoesNotFit)};
  std::vector<std::string> named;
  for (const json& each : loops_json(loops, two_keyframes()))
    named.push_back(each["status"].get<std::string>() + ": " + each["reason"].get<std::string>());
  EXPECT_EQ(named, (std::vector<std::string>{"accepted: fits the map", "accepted: loaded",
                                             "provisional: too few keyframes", "provisional: ambiguous",
                                             "rejected: different scale", "withdrawn: does not fit"}));
}

TEST(LoopsJson, NoLoopsAreAnEmptyList) {
  EXPECT_EQ(loops_json({}, two_keyframes()), json::array());
}

}  // namespace
}  // namespace kinloop
