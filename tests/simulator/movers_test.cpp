// What moves in a simulated room: people, a door and chairs, as solids.

#include <algorithm>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/room/room.hpp"

namespace kinloop::sim {
namespace {

constexpr double kSeconds = 20;

MoverOptions all_movers() {
  MoverOptions movers;
  movers.people = 2;
  movers.door = true;
  movers.chairs = 2;
  return movers;
}

Room room_of(uint64_t seed, const MoverOptions& movers, bool spacious = false) {
  return build_room(handheld_path(seed, kSeconds), {seed, spacious, movers}, 2);
}

/// Built once for all tests.
const Room& busy_room() {
  static const Room room = room_of(1, all_movers());
  return room;
}
const Movers& movers() {
  return busy_room().scene->movers();
}

/// Every 30 ms.
std::vector<double> times() {
  std::vector<double> all;
  for (double t = 0; t < kSeconds; t += 0.03) all.push_back(t);
  return all;
}

double depth_in(const Primitive& solid, const Eigen::Vector3f& p) {
  return -signed_distance_m(solid, p.cast<double>());
}

/// How many solids of a person hold a point.
long holders(const Parts& parts, const Eigen::Vector3f& p) {
  return std::count_if(parts.begin(), parts.end(), [&](const Primitive& s) { return depth_in(s, p) > 0; });
}

bool same_poses(const Parts& a, const Parts& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Primitive& x, const Primitive& y) {
    return x.center == y.center && x.R_room_local == y.R_room_local && x.half == y.half;
  });
}

TEST(Walk, SegmentsJoinAndSpeedsAreThoseOfPeople) {
  ASSERT_EQ(movers().people.size(), 2U);
  for (const Person& person : movers().people) {
    ASSERT_GE(person.walk.back().end_s(), kSeconds - 0.1);
    constexpr double kStep_s = 0.01;
    double fastest = 0, walked_m = 0;
    for (double t = 0; t < kSeconds; t += kStep_s) {
      const WalkState a = state_at(person.walk, t), b = state_at(person.walk, t + kStep_s);
      const double moved_m = (b.position - a.position).norm();
      fastest = std::max(fastest, moved_m / kStep_s);
      walked_m += moved_m;
      EXPECT_LT(std::abs(b.heading_rad - a.heading_rad), 4 * kStep_s);
      EXPECT_GE(b.phase, a.phase - 1e-12);
      EXPECT_LT(b.phase - a.phase, 2 * kStep_s);
    }
    EXPECT_LT(fastest, 1.41);
    EXPECT_GT(fastest, 0.79);
    EXPECT_GT(walked_m, 5);
  }
}

TEST(Walk, StepsGrowWithSpeedAndEndSideBySide) {
  const WalkSegment start;
  double slow_step_m = 0;
  for (const double speed : {0.8, 1.4}) {
    const WalkSegment way = straight_after(start, {6, 0}, speed);
    const WalkState middle = state_in(way, way.begin_s + way.seconds / 2);
    EXPECT_NEAR(middle.position.x(), 3, 1e-9);
    EXPECT_GT(middle.step_m, slow_step_m + 0.05);
    slow_step_m = middle.step_m;
    const WalkState end = state_in(way, way.end_s());
    EXPECT_NEAR((end.position - Eigen::Vector2d(6, 0)).norm(), 0, 1e-9);
    EXPECT_EQ(end.step_m, 0);
    EXPECT_NEAR(std::remainder(end.phase, 0.5), 0, 1e-12);
  }
}

TEST(Person, LimbsKeepTheirLengthAndStayAttached) {
  ASSERT_EQ(movers().people.size(), 2U);
  for (const Person& person : movers().people) {
    const Figure& figure = person.figure;
    for (const double t : times()) {
      const Joints joints = joints_at(person, t);
      const Parts parts = person_at(person, t);
      for (const Leg& leg : joints.legs) {
        ASSERT_NEAR((leg.knee - leg.hip).norm(), figure.thigh_m(), 1e-4);
        ASSERT_NEAR((leg.ankle - leg.knee).norm(), figure.shank_m(), 1e-4);
        ASSERT_NEAR((leg.toe - leg.heel).norm(), figure.foot_m(), 1e-4);
        ASSERT_GE(holders(parts, leg.hip), 2);
        ASSERT_GE(holders(parts, leg.knee), 2);
        ASSERT_GE(holders(parts, leg.ankle), 1);
      }
      for (const Arm& arm : joints.arms) {
        ASSERT_NEAR((arm.elbow - arm.shoulder).norm(), figure.upper_arm_m(), 1e-4);
        ASSERT_NEAR((arm.wrist - arm.elbow).norm(), figure.forearm_m(), 1e-4);
        ASSERT_GE(holders(parts, arm.shoulder), 2);
        ASSERT_GE(holders(parts, arm.elbow), 2);
        ASSERT_GE(holders(parts, arm.wrist), 2);
      }
      ASSERT_GE(holders(parts, joints.neck), 2);
      ASSERT_GE(holders(parts, joints.head), 2);
    }
  }
}

TEST(Person, StandsOnTheFloorInsideTheRoom) {
  const Eigen::Vector2f half = busy_room().size_m.head<2>().cast<float>() / 2;
  ASSERT_EQ(movers().people.size(), 2U);
  for (const Person& person : movers().people) {
    for (const double t : times()) {
      const Eigen::AlignedBox3f box = bounds(person_at(person, t));
      ASSERT_NEAR(box.min().z(), 0, 0.025);                     // the rounded tip of a shoe that points down
      ASSERT_LT(box.max().z(), person.figure.height_m + 0.04);  // hair
      ASSERT_GT(box.max().z(), person.figure.height_m - 0.14);  // lower in the middle of a long step
      ASSERT_TRUE((box.max().head<2>().array() < half.array()).all());
      ASSERT_TRUE((box.min().head<2>().array() > -half.array()).all());
      float lowest_sole_m = 1;
      for (const Leg& leg : joints_at(person, t).legs)
        lowest_sole_m = std::min({lowest_sole_m, leg.heel.z(), leg.toe.z()});
      ASSERT_NEAR(lowest_sole_m, 0, 1e-5);
    }
  }
}

TEST(Person, SwingsLegsAndArmsAgainstEachOther) {
  const Figure figure;
  WalkState state;
  state.phase = 0.25;  // left leg in front
  state.step_m = 0.7;
  const Joints joints = joints_of(figure, state, 0);
  EXPECT_GT(joints.legs[0].ankle.x(), joints.legs[1].ankle.x() + 0.5F);
  EXPECT_LT(joints.arms[0].wrist.x(), joints.arms[1].wrist.x() - 0.3F);
  EXPECT_GT(joints.legs[0].hip.y(), joints.legs[1].hip.y());
  state.step_m = 0;
  const Joints standing = joints_of(figure, state, 0);
  EXPECT_NEAR(standing.legs[0].ankle.x(), standing.legs[1].ankle.x(), 1e-5);
}

TEST(Person, KeepsClearOfFurnitureCameraAndOthers) {
  const Room& room = busy_room();
  const CameraPath path(in_room_frame(handheld_path(1, kSeconds), room.T_world_room.inverse()));
  const FreeFloor floor(room.scene->primitives(), room.size_m.cast<float>(), 0.2F);
  const std::vector<Person>& people = movers().people;
  ASSERT_EQ(people.size(), 2U);
  for (const double t : times()) {
    const Eigen::Vector2d camera = path.at(movers().begin_ns + to_ns(t)).translation.head<2>();
    std::vector<Eigen::Vector2d> at;
    for (const Person& person : people) at.push_back(state_at(person.walk, t).position);
    for (const Eigen::Vector2d& p : at) {
      ASSERT_TRUE(floor.is_free(p)) << p.transpose() << " at " << t;
      ASSERT_GT((p - camera).norm(), 0.6);
    }
    ASSERT_GT((at[0] - at[1]).norm(), 0.6);
  }
}

TEST(SwingingDoor, TurnsAboutItsHinge) {
  ASSERT_TRUE(movers().door.has_value());
  const SwingingDoor& door = *movers().door;
  ASSERT_GE(door.swings.size(), 2U);
  EXPECT_TRUE(same_poses(door_at(door, 0), moved(moved(door.closed, 0, -door.hinge), 0, door.hinge)));
  float widest_rad = 0;
  for (const double t : times()) {
    const float angle = angle_at(door, t);
    widest_rad = std::max(widest_rad, angle);
    ASSERT_GE(angle, 0);
    ASSERT_LT(std::abs(angle_at(door, t + 0.01) - angle), 0.04F);
    if (!is_turning(door, t)) {
      ASSERT_EQ(angle_at(door, t), angle_at(door, t + 1e-4));
    }
    const Parts turned = door_at(door, t);
    ASSERT_EQ(turned.size(), door.closed.size());
    for (size_t i = 0; i < turned.size(); ++i) {
      const Eigen::Vector3f before = door.closed[i].center - door.hinge, now = turned[i].center - door.hinge;
      ASSERT_NEAR(now.z(), before.z(), 1e-5);
      ASSERT_NEAR(now.head<2>().norm(), before.head<2>().norm(), 1e-5);
      const Eigen::Vector2f rotated = Eigen::Rotation2Df(angle) * before.head<2>();
      ASSERT_NEAR((now.head<2>() - rotated).norm(), 0, 1e-4);
    }
  }
  EXPECT_GT(widest_rad, 0.9F);
}

TEST(SwingingDoor, OpensIntoACorridorBehindTheWall) {
  const SwingingDoor& door = *movers().door;
  const Eigen::Vector2f half = busy_room().size_m.head<2>().cast<float>() / 2;
  const auto outside_m = [&](const Eigen::Vector3f& p) { return (p.head<2>().cwiseAbs() - half).maxCoeff(); };
  const Primitive& closed = door.closed.front();
  const Primitive open = moved(moved(closed, 0, -door.hinge), 1.5F, door.hinge);
  EXPECT_LT(outside_m(closed.center), 0);
  EXPECT_GT(outside_m(open.center), 0.3F);
  // Nothing of the wall is left in the opening, and the corridor ends behind the open door.
  const Eigen::Vector3d way = (closed.R_room_local.col(1)).cast<double>();
  const Eigen::Vector3d through = closed.center.cast<double>() + 0.1 * way;
  EXPECT_GT(busy_room().scene->distance_to_surface(through), 0.3);
  EXPECT_LT(busy_room().scene->distance_to_surface(closed.center.cast<double>() + 1.82 * way), 0.05);
}

TEST(PushedChair, StaysWhereItWasPushed) {
  ASSERT_EQ(movers().chairs.size(), 2U);
  for (const PushedChair& chair : movers().chairs) {
    EXPECT_GT(chair.begin_s, 0);
    EXPECT_LT(chair.begin_s + chair.seconds, kSeconds);
    const double end_s = chair.begin_s + chair.seconds;
    EXPECT_TRUE(same_poses(chair_at(chair, 0), chair_at(chair, chair.begin_s)));
    EXPECT_TRUE(same_poses(chair_at(chair, end_s), chair_at(chair, kSeconds + 100)));
    EXPECT_GT((chair.after.position - chair.before.position).norm(), 0.39F);
    for (const double t : times()) {
      EXPECT_NEAR(bounds(chair_at(chair, t)).min().z(), 0, 1e-4);
      EXPECT_EQ(is_pushed(chair, t), t > chair.begin_s && t < end_s);
    }
    const ChairPlace middle = place_at(chair, chair.begin_s + chair.seconds / 2);
    EXPECT_NEAR((middle.position - (chair.before.position + chair.after.position) / 2).norm(), 0, 1e-4);
  }
}

TEST(Movers, AreTheSameForTheSameSeedAndDifferForOthers) {
  const Room again = room_of(1, all_movers()), other = room_of(2, all_movers());
  for (const int64_t stamp_ns : {to_ns(1), to_ns(9.3), to_ns(30)}) {
    EXPECT_TRUE(same_poses(movers().at(stamp_ns).parts, again.scene->movers().at(stamp_ns).parts));
    EXPECT_FALSE(same_poses(movers().at(stamp_ns).parts, other.scene->movers().at(stamp_ns).parts));
  }
}

TEST(Movers, PeopleDoNotChangeTheRoom) {
  MoverOptions people;
  people.people = 2;
  const Room with = room_of(3, people), without = room_of(3, {}, true);
  EXPECT_TRUE(without.scene->movers().empty());
  EXPECT_TRUE(same_poses(with.scene->primitives(), without.scene->primitives()));
  const SwingingDoor& door = *movers().door;
  const Room closed = room_of(1, {}, true);
  const Parts& parts = closed.scene->primitives();
  EXPECT_TRUE(std::any_of(parts.begin(), parts.end(),
                          [&](const Primitive& part) { return part.center == door.closed[0].center; }));
}

TEST(FreeFloor, KeepsTheRadiusFromThingsAndWalls) {
  const Parts room{make_box({0, 0, 0.5F}, {1, 1, 1}, {}), make_box({0, 0, 2.5F}, {6, 6, 0.1F}, {}),
                   make_box({0, 0, 0.005F}, {5, 5, 0.01F}, {}), make_box({3.05F, 0, 1}, {0.1F, 6, 2}, {})};
  FreeFloor floor(room, {6, 6, 2.6F}, 0.3F);
  EXPECT_FALSE(floor.is_free({0.7, 0}));
  EXPECT_TRUE(floor.is_free({1.0, 0}));
  EXPECT_FALSE(floor.is_free({2.8, 0}));
  EXPECT_FALSE(floor.is_free({9, 0}));
  EXPECT_FALSE(floor.is_free({-1.5, 0}, {1.5, 0}));
  EXPECT_TRUE(floor.is_free({-1.5, 1.2}, {1.5, 1.2}));
  const size_t before = floor.largest_region().size();
  floor.block({Eigen::Vector2f(1, 1), Eigen::Vector2f(2, 2)});
  EXPECT_LT(floor.largest_region().size(), before);
  FreeFloor none({make_box({0, 0, 0.5F}, {9, 9, 1}, {})}, {6, 6, 2.6F}, 0.3F);
  EXPECT_TRUE(none.largest_region().empty());
  Random random(1);
  const FloorTrack track{{{Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0)}}};
  EXPECT_THROW(plan_walk(none, track, {}, random), InputError);
}

}  // namespace
}  // namespace kinloop::sim
