#pragma once
// In: a figure, its clothes and its walk. Out: the solids of the person at a time.

#include <array>

#include <Eigen/Geometry>

#include "simulator/movers/people/clothes.hpp"
#include "simulator/movers/people/walk.hpp"
#include "simulator/room/furniture.hpp"

namespace kinloop::sim {

constexpr size_t kSides = 2;  ///< left, right

/// Lengths of a body, m: shares of its height (Drillis and Contini 1966, "Body segment parameters").
struct Figure {
  float height_m = 1.75F;
  float girth = 1;  ///< factor of all widths

  [[nodiscard]] float thigh_m() const { return 0.245F * height_m; }
  [[nodiscard]] float shank_m() const { return 0.246F * height_m; }
  [[nodiscard]] float ankle_m() const { return 0.039F * height_m; }  ///< above the sole
  [[nodiscard]] float foot_m() const { return 0.152F * height_m; }
  [[nodiscard]] float upper_arm_m() const { return 0.186F * height_m; }
  [[nodiscard]] float forearm_m() const { return 0.146F * height_m; }
  [[nodiscard]] float hand_m() const { return 0.1F * height_m; }
  [[nodiscard]] float trunk_m() const { return 0.29F * height_m; }  ///< from the hips to the neck
};

/// Joints of a leg, and both ends of the sole.
struct Leg {
  Eigen::Vector3f hip, knee, ankle, heel, toe;
};

/// Joints of an arm, and the end of the hand.
struct Arm {
  Eigen::Vector3f shoulder, elbow, wrist, fingertips;
};

/// A body in the room frame. Of the rotations, x points ahead, y to the left and z up.
struct Joints {
  Eigen::Matrix3f R_room_pelvis, R_room_trunk, R_room_head;
  Eigen::Vector3f pelvis, neck, head;  ///< between the hips, below and in the middle of the head
  std::array<Leg, kSides> legs;
  std::array<Arm, kSides> arms;
};

/// Returns the joints of a walker, who stands on the floor with the lower foot. Arms swing against the legs;
/// the knee of the leg in the air bends. `time_s` moves the head and sways the trunk a little.
Joints joints_of(const Figure& figure, const WalkState& state, double time_s);

/// Somebody who walks about in a room.
struct Person {
  Figure figure;
  Outfit outfit;
  Walk walk;
};

/// Returns the joints of a person at a time since the beginning of the walk.
Joints joints_at(const Person& person, double time_s);

/// Returns the solids of a person at a time since the beginning of the walk. Neighbouring solids overlap at
/// the joint between them.
Parts person_at(const Person& person, double time_s);

}  // namespace kinloop::sim
