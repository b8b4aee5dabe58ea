// The scene of two compared maps.

#include "viewer/saved/comparison.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "tests/viewer/scene_parts.hpp"

namespace kinloop {
namespace {

using nlohmann::json;
using testing::ElementsAre;

constexpr Rgb kGray = {100, 100, 100};

ColoredCloud points_at(std::vector<Eigen::Vector3f> points) {
  ColoredCloud cloud;
  cloud.colors.assign(points.size(), kGray);
  cloud.points = std::move(points);
  return cloud;
}

/// A wall that stayed, a chair that was moved from x = 1 to x = 2, a box that is gone, and a lamp that is
/// new.
Comparison visits() {
  Comparison comparison;
  comparison.before = {
      "monday", {{1, {}}, {2, {}}}, {{1, {}}}, points_at({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {5, 0, 0}}), {}};
  comparison.after = {
      "tuesday", {{1, {}}}, {{1, {}}, {3, {}}}, points_at({{2, 0, 0}, {2, 1, 0}, {0, 0, 0}, {7, 0, 0}}), {}};
  using enum PointChange;
  comparison.difference.before = {kSame, kChanged, kChanged, kChanged};
  comparison.difference.after = {kChanged, kChanged, kSame, kChanged};
  comparison.difference.objects = {{ObjectChange::kMoved, {1, 0.5, 0}, {2, 0.5, 0}, 0.1, {1, 2}, {0, 1}},
                                   {ObjectChange::kGone, {5, 0, 0}, {5, 0, 0}, 0.2, {3}, {}}};
  comparison.loops = {{KeyframeId{0}, KeyframeId{2}}};
  comparison.loops_between = 1;
  return comparison;
}

TEST(ComparedMaps, EveryPointIsInOneLayer) {
  const auto positions = [](DifferenceLayer layer) {
    std::vector<float> x;
    for (const auto& point : layer_of(visits(), layer).points) x.push_back(point.x());
    return x;
  };
  EXPECT_THAT(positions(DifferenceLayer::kRestBefore), ElementsAre(0));
  EXPECT_THAT(positions(DifferenceLayer::kRestAfter), ElementsAre(0));
  EXPECT_THAT(positions(DifferenceLayer::kGone), ElementsAre(5));
  EXPECT_THAT(positions(DifferenceLayer::kAdded), ElementsAre(7)) << "also what is too small for an object";
  EXPECT_THAT(positions(DifferenceLayer::kMoved), ElementsAre(1, 1, 2, 2)) << "where it was and where it is";
}

TEST(ComparedMaps, WhatChangedIsMoreColourfulThanTheRest) {
  const auto saturation = [](DifferenceLayer layer) {
    const auto [low, high] = std::ranges::minmax(layer_of(visits(), layer).colors.back());
    return high - low;
  };
  const int rest =
      std::max(saturation(DifferenceLayer::kRestBefore), saturation(DifferenceLayer::kRestAfter));
  for (const auto layer : {DifferenceLayer::kGone, DifferenceLayer::kAdded, DifferenceLayer::kMoved})
    EXPECT_GT(saturation(layer), 2 * rest);
}

TEST(ComparedMaps, TheSceneSaysWhichPiecesShowWhat) {
  Scene scene("x");
  show_comparison(scene, visits());
  const json table = test::json_of(*test::part(scene, PartKind::kComparison));
  EXPECT_EQ(table["pieces"]["gone"], json({0, 1}));
  EXPECT_EQ(table["pieces"]["restAfter"], json({4, 5}));
  EXPECT_EQ(test::parts(scene, PartKind::kCloud).size(), 5U);
  EXPECT_EQ(table["names"], json({"monday", "tuesday"}));
  EXPECT_EQ(table["keyframesBefore"], 1);
  EXPECT_EQ(table["loopsBetween"], 1);
  EXPECT_EQ(table["before"]["gone"], 3) << "as map diff counts";
  EXPECT_EQ(table["objects"][0]["moved_by_m"], 1.0);
  EXPECT_EQ(test::part(scene, PartKind::kKeyframes)->body->size(), 3U * 7 * sizeof(float)) << "those of both";
  EXPECT_EQ(test::part(scene, PartKind::kPath)->body->size(), 2U * 4 * sizeof(float));
  EXPECT_EQ(test::part(scene, PartKind::kOtherPath)->body->size(), 3U * sizeof(float));
  EXPECT_EQ(*test::part(scene, PartKind::kLoops)->body, encode_pairs(visits().loops));
}

TEST(ComparedMaps, TheSceneHasTheFramesOfBothWithTheirKeyframes) {
  Comparison comparison = visits();
  TimelineFrame frame;
  frame.keyframe = KeyframeId{0};
  comparison.before.timeline = {frame};
  comparison.after.timeline = {frame, TimelineFrame()};
  Scene scene("x");
  show_comparison(scene, comparison);
  const auto timelines = test::parts(scene, PartKind::kTimeline);
  ASSERT_EQ(timelines.size(), 2U);
  EXPECT_EQ(*timelines[0].body, encode_timeline(comparison.before.timeline));
  comparison.after.timeline[0].keyframe = KeyframeId{1};
  EXPECT_EQ(*timelines[1].body, encode_timeline(comparison.after.timeline)) << "numbered as in the scene";
}

TEST(ComparedMaps, ObjectsHaveUprightBoxes) {
  Comparison comparison = visits();
  comparison.R_file_world = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ());
  Scene scene("x");
  show_comparison(scene, comparison);
  const json objects = test::json_of(*test::part(scene, PartKind::kComparison))["objects"];
  EXPECT_TRUE(objects[1]["boxAfter"].is_null()) << "it is gone";
  const json& corners = objects[0]["boxBefore"];
  ASSERT_EQ(corners.size(), 8U);
  const auto corner = [&](size_t i) {
    return Eigen::Vector3f(corners[i][0].get<float>(), corners[i][1].get<float>(),
                           corners[i][2].get<float>());
  };
  // The ends of the chair are a diagonal of the box, whose edges are along the axes of the file.
  const Eigen::Vector3f edge = corner(1) - corner(0);
  EXPECT_NEAR(edge.norm(), std::sin(0.3), 1e-5);
  EXPECT_NEAR(edge.normalized().dot(Eigen::Vector3f(std::cos(0.3F), -std::sin(0.3F), 0)), 1, 1e-5);
  EXPECT_NEAR((corner(2) - corner(0)).norm(), std::cos(0.3), 1e-5);
}

}  // namespace
}  // namespace kinloop
