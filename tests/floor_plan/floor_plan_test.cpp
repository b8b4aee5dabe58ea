#include "tools/floor_plan/floor_plan.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/floor_plan/box_world.hpp"
#include "tests/support/expect_error.hpp"
#include "tools/floor_plan/drawing/draw_plan.hpp"

namespace kinloop {
namespace {

using test::BoxWorld;
using test::Panel;
using testing::HasSubstr;

constexpr double kWall_m = 0.02;

std::vector<double> lengths_m(const PlanRoom& room) {
  std::vector<double> lengths;
  for (const PlanWall& wall : room.walls) lengths.push_back(wall.length_m());
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

std::vector<PlanOpening> openings_of(const PlanRoom& room) {
  std::vector<PlanOpening> openings;
  for (const PlanWall& wall : room.walls)
    openings.insert(openings.end(), wall.openings.begin(), wall.openings.end());
  return openings;
}

TEST(FloorPlan, OfAnAngledRoomHasItsWallsAndArea) {
  BoxWorld world(BoxWorld::closed({{0, 0}, {5, 0}, {5, 2}, {3, 2}, {3, 4}, {0, 4}}));
  world.look_around({1.5, 1.5});
  world.look_around({4, 1});
  const FloorPlan plan = world.plan();
  ASSERT_EQ(plan.rooms.size(), 1U);
  EXPECT_NEAR(plan.rooms[0].area_m2, 16, 0.1);
  EXPECT_NEAR(plan.rooms[0].perimeter_m, 18, 0.1);
  EXPECT_THAT(lengths_m(plan.rooms[0]),
              testing::Pointwise(testing::DoubleNear(kWall_m), {2.0, 2.0, 2.0, 3.0, 4.0, 5.0}));
  EXPECT_THAT(openings_of(plan.rooms[0]), testing::IsEmpty());
  ASSERT_TRUE(plan.ceiling_m.has_value());
  EXPECT_NEAR(*plan.ceiling_m, 2.5, 0.01);
}

TEST(FloorPlan, KeepsWallsThatAreNotPerpendicular) {
  BoxWorld world(BoxWorld::closed({{0, 0}, {5, 0}, {5, 3}, {3.5, 4.5}, {0, 4.5}}));
  world.look_around({2, 2});
  const FloorPlan plan = world.plan();
  ASSERT_EQ(plan.rooms.size(), 1U);
  EXPECT_NEAR(plan.rooms[0].area_m2, 5 * 4.5 - 1.5 * 1.5 / 2, 0.15);
  EXPECT_THAT(lengths_m(plan.rooms[0]), testing::Pointwise(testing::DoubleNear(2 * kWall_m),
                                                           {1.5 * std::sqrt(2.0), 3.0, 3.5, 4.5, 5.0}));
}

/// Two rooms of 4 x 4 and 3 x 4 m, whose wall of 10 cm has a doorway of 90 cm.
BoxWorld two_rooms() {
  std::vector<Panel> panels = BoxWorld::closed({{0, 0}, {7.1, 0}, {7.1, 4}, {0, 4}});
  for (const double x : {4.0, 4.1}) {
    panels.push_back({{x, 0}, {x, 1.5}});
    panels.push_back({{x, 2.4}, {x, 4}});
    panels.push_back({{x, 1.5}, {x, 2.4}, 2.0, 2.5});
  }
  for (const double y : {1.5, 2.4}) panels.push_back({{4, y}, {4.1, y}, 0, 2.0});
  BoxWorld world(panels);
  for (const double x : {1.0, 2.5, 4.6, 6.0}) world.look_around({x, 2});
  return world;
}

TEST(FloorPlan, PartsRoomsAtADoorway) {
  const FloorPlan plan = two_rooms().plan();
  ASSERT_EQ(plan.rooms.size(), 2U);
  EXPECT_NEAR(plan.rooms[0].area_m2, 16, 0.15);
  EXPECT_NEAR(plan.rooms[1].area_m2, 12, 0.15);
  for (const PlanRoom& room : plan.rooms) {
    const auto openings = openings_of(room);
    ASSERT_EQ(openings.size(), 1U);
    EXPECT_EQ(openings[0].kind, OpeningKind::kDoorway);
    EXPECT_NEAR(openings[0].end_m - openings[0].begin_m, 0.9, 0.1);
  }
}

TEST(FloorPlan, AnOpeningAboveASillIsAHole) {
  std::vector<Panel> panels = BoxWorld::closed({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
  panels[1] = {{4, 0}, {4, 1.2}};
  panels.push_back({{4, 2.6}, {4, 4}});
  panels.push_back({{4, 1.2}, {4, 2.6}, 0, 0.85});
  panels.push_back({{4, 1.2}, {4, 2.6}, 2.1, 2.5});
  panels.push_back({{6, -2}, {6, 6}});  // what is seen through it
  BoxWorld world(panels);
  for (const double y : {1.0, 2.0, 3.0}) world.look_around({2, y});
  const FloorPlan plan = world.plan();
  ASSERT_GE(plan.rooms.size(), 1U);
  EXPECT_NEAR(plan.rooms[0].area_m2, 16, 0.3);
  const auto openings = openings_of(plan.rooms[0]);
  ASSERT_EQ(openings.size(), 1U);
  EXPECT_EQ(openings[0].kind, OpeningKind::kHole);
  EXPECT_NEAR(openings[0].end_m - openings[0].begin_m, 1.4, 0.15);
}

TEST(FloorPlan, FurnitureIsNoWall) {
  std::vector<Panel> panels = BoxWorld::closed({{0, 0}, {5, 0}, {5, 4}, {0, 4}});
  // A shelf along a wall, and a block in a corner: both end below the ceiling.
  panels.push_back({{1, 3.7}, {3, 3.7}, 0, 2.0});
  panels.push_back({{1, 3.7}, {1, 4}, 0, 2.0});
  panels.push_back({{3, 3.7}, {3, 4}, 0, 2.0});
  panels.push_back({{4.5, 0}, {4.5, 1}, 0, 1.9});
  panels.push_back({{4.5, 1}, {5, 1}, 0, 1.9});
  BoxWorld world(panels);
  world.look_around({1.5, 1.5});
  world.look_around({3, 2});
  const FloorPlan plan = world.plan();
  ASSERT_EQ(plan.rooms.size(), 1U);
  EXPECT_NEAR(plan.rooms[0].area_m2, 20, 0.1);
  EXPECT_EQ(plan.rooms[0].walls.size(), 4U);
}

TEST(FloorPlan, OfNothingIsAnError) {
  const ColoredCloud empty;
  const ImageStore images;
  const PinholeCamera camera{120, 120, 60, 60, 59.5, 59.5, {}};
  EXPECT_THAT(test::input_error([&] {
                (void)make_floor_plan({empty, images, {}, camera, Eigen::Quaterniond::Identity()});
              }),
              HasSubstr("no floor"));
}

TEST(FloorPlan, JsonAndDrawingHaveTheNumbers) {
  const FloorPlan plan = two_rooms().plan();
  const auto figures = to_json(plan);
  ASSERT_EQ(figures["rooms"].size(), 2U);
  EXPECT_NEAR(figures["rooms"][0]["area_m2"].get<double>(), plan.rooms[0].area_m2, 1e-4);
  double around_m = 0;
  for (const auto& wall : figures["rooms"][0]["walls"]) around_m += wall["length_m"].get<double>();
  EXPECT_NEAR(around_m, plan.rooms[0].perimeter_m, 1e-3);
  const std::string svg = svg_of(draw_plan(plan, "flat"));
  EXPECT_THAT(svg, HasSubstr("<title>flat</title>"));
  EXPECT_THAT(svg, HasSubstr(fmt::format(">{:.2f} m²</text>", plan.rooms[0].area_m2)));
  EXPECT_THAT(svg, HasSubstr(">Room 2</text>"));
}

}  // namespace
}  // namespace kinloop
