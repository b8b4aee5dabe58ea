// The loops that the page of a saved run lists.

#include "viewer/saved/saved_loops.hpp"

#include <memory>

#include <gmock/gmock.h>

#include "kinloop/core/time.hpp"
#include "tests/support/temp_folder.hpp"
#include "viewer/saved/saved_map.hpp"

namespace kinloop {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::Pair;

const Trajectory kKeyframes = {{kNsPerSecond, {}}, {2 * kNsPerSecond, {}}, {3 * kNsPerSecond, {}}};

json listed(const char* a, const char* b, const char* status, const char* reason) {
  return {{"stamp_a", a},     {"stamp_b", b},     {"inliers", 57},   {"support", 3},
          {"scale", nullptr}, {"status", status}, {"reason", reason}};
}

TEST(SavedLoops, AreThoseOfTheRunWithStatusAndReason) {
  json accepted = listed("1", "3", "accepted", "keyframes agree");
  accepted["scale"] = 1.01;
  const json figures = {{"loops", {accepted}},
                        {"other_loops", {listed("2", "9.5", "rejected", "different scale")}}};
  const auto loops = loops_of(figures, kKeyframes);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_EQ(loops[0].stamp_a_ns, kNsPerSecond);
  EXPECT_EQ(loops[0].a, KeyframeId{0});
  EXPECT_EQ(loops[0].b, KeyframeId{2});
  EXPECT_EQ(loops[0].inliers, 57);
  EXPECT_EQ(loops[0].support, 3);
  EXPECT_EQ(loops[0].scale, 1.01);
  EXPECT_EQ(loops[0].stage, LoopStage::kAccepted);
  EXPECT_EQ(loops[0].reason, LoopReason::kKeyframesAgree);
  EXPECT_EQ(loops[1].stage, LoopStage::kRejected);
  EXPECT_EQ(loops[1].reason, LoopReason::kScale);
  EXPECT_FALSE(loops[1].scale);
  EXPECT_FALSE(loops[1].b.valid()) << "its keyframe is not shown";
  EXPECT_THAT(accepted_pairs(loops), ElementsAre(Pair(KeyframeId{0}, KeyframeId{2})));
}

TEST(SavedLoops, OfAnEarlierVersionAreAccepted) {
  const auto loops =
      loops_of({{"loops", {{{"stamp_a", "1"}, {"stamp_b", "2"}, {"inliers", 40}}}}}, kKeyframes);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops[0].stage, LoopStage::kAccepted);
  EXPECT_EQ(loops[0].reason, LoopReason::kNone);
  EXPECT_EQ(loops[0].support, 0) << "unknown";
}

TEST(SavedLoops, DamagedOnesAreLeftOut) {
  json damaged = listed("1", "2", "accepted", "keyframes agree");
  damaged["stamp_b"] = "soon";
  json strange = listed("1", "2", "provisional", "by chance");
  strange["inliers"] = "many";
  const json figures = {
      {"loops", {damaged, 7, listed("1", "2", "perhaps", "none"), listed("1", "2", "hypothesis", "none")}},
      {"other_loops", {strange, {{"stamp_a", 3}}}}};
  const auto loops = loops_of(figures, kKeyframes);
  ASSERT_EQ(loops.size(), 1U);
  EXPECT_EQ(loops[0].stage, LoopStage::kProvisional);
  EXPECT_EQ(loops[0].reason, LoopReason::kNone);
  EXPECT_EQ(loops[0].inliers, 0);
  EXPECT_TRUE(loops_of({{"loops", 7}}, kKeyframes).empty());
  EXPECT_TRUE(loops_of(json(), kKeyframes).empty());
}

TEST(SavedLoops, OfAMapAreItsEdgesAndTheOthers) {
  Map map;
  for (uint32_t i = 0; i < 3; ++i)
    map.add_keyframe(FrameId{i}, (i + 1) * kNsPerSecond, {}, std::make_shared<const Features>());
  LoopClosure loop;
  loop.a = KeyframeId{0};
  loop.b = KeyframeId{2};
  loop.stage = LoopStage::kVerified;
  loop.evidence.scale = {.factor = 0.99, .sigma = 0.01};
  map.add_loop_closure(loop);
  LoopClosure other;
  other.a = KeyframeId{0};
  other.b = KeyframeId{1};
  other.stage = LoopStage::kProvisional;
  other.reason = LoopReason::kAmbiguous;
  map.record_loop(other);
  const auto loops = loops_of(map);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_EQ(loops[0].stage, LoopStage::kAccepted);
  EXPECT_EQ(loops[0].stamp_b_ns, 3 * kNsPerSecond);
  EXPECT_EQ(loops[0].scale, 0.99);
  EXPECT_EQ(loops[1].reason, LoopReason::kAmbiguous);
  EXPECT_FALSE(loops[1].scale);
}

/// The body of the only part of that kind.
WireBytes body_of(const SavedRun& run, PartKind kind) {
  Scene scene("x");
  show_saved_run(scene, run);
  for (auto part = scene.next_after(0); part; part = scene.next_after(part->version))
    if (part->kind == kind) return *part->body;
  return {};
}

TEST(SavedLoops, ThePageGetsThemAllAndEdgesOfTheAcceptedOnes) {
  const test::TempFolder folder;
  folder.write("trajectory.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 1 0 0 0 0 0 1\n");
  folder.write("keyframes.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 1 0 0 0 0 0 1\n");
  const json figures = {{"loops", {listed("1", "3", "accepted", "keyframes agree")}},
                        {"other_loops", {listed("2", "9.5", "withdrawn", "does not fit")}}};
  folder.write("run.json", figures.dump());
  folder.write("map.kinmap", "");
  const SavedRun run = read_shown(folder.path(), {});
  const std::vector<std::pair<KeyframeId, KeyframeId>> edges = {{KeyframeId{0}, KeyframeId{2}}};
  EXPECT_EQ(body_of(run, PartKind::kLoops), encode_pairs(edges));
  const WireBytes body = body_of(run, PartKind::kLoopTable);
  const json table = json::parse(body.begin(), body.end());
  EXPECT_EQ(table["map"], (folder.path() / "map.kinmap").string());
  ASSERT_EQ(table["loops"].size(), 2U);
  EXPECT_EQ(table["loops"][1], json::parse(R"({"stampA": "2.000000", "stampB": "9.500000", "a": 1, "b": null,
      "inliers": 57, "support": 3, "scale": null, "status": "withdrawn", "reason": "does not fit"})"));
  EXPECT_TRUE(body_of(SavedRun(), PartKind::kLoopTable).empty()) << "without loops there is no table";
}

}  // namespace
}  // namespace kinloop
