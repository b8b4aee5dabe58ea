#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulator/movers/people/person.hpp"

namespace kinloop::sim {
namespace {

using Eigen::AngleAxisf;
using Eigen::Matrix3f;
using Eigen::Vector3f;

/// How far a walker is into its gait.
struct Gait {
  float angle_rad;  ///< of the left leg: -pi / 2 farthest back, 0 passing the other in the air
  float swing_rad;  ///< of the hips, to either side
  float vigour;     ///< 0 standing to 1 walking
};

Gait gait_of(const Figure& figure, const WalkState& state) {
  constexpr double kFullStep_m = 0.55;
  constexpr float kMaxSwing = 0.55F;  // sine
  const float leg_m = figure.thigh_m() + figure.shank_m();
  const float sine = std::min(kMaxSwing, static_cast<float>(state.step_m) / (2 * leg_m));
  const double turn = 2 * std::numbers::pi * (state.phase - std::floor(state.phase));
  return {static_cast<float>(turn), std::asin(sine),
          static_cast<float>(std::min(1.0, state.step_m / kFullStep_m))};
}

float side_sign(size_t side) {
  return side == 0 ? 1.0F : -1.0F;
}

/// Angle of the gait for one leg; the arm of the other side has the same.
float side_angle(const Gait& gait, size_t side) {
  return gait.angle_rad + (side == 0 ? 0 : std::numbers::pi_v<float>);
}

float positive(float x) {
  return std::max(0.0F, x);
}

/// A direction in the plane ahead, by its angle forwards from straight down.
Vector3f downwards(float forwards_rad) {
  return {std::sin(forwards_rad), 0, -std::cos(forwards_rad)};
}

Leg leg_of(const Figure& figure, const Gait& gait, size_t side, const Matrix3f& R) {
  constexpr float kHipWidth = 0.055F;  // of the height, from the middle
  constexpr float kLead_rad = 0.75F, kBend_rad = 1.1F, kSoftKnee_rad = 0.06F;
  constexpr float kToeDown_rad = 0.55F, kToeUp_rad = 0.3F, kBehindAnkle = 0.25F;
  const float angle = side_angle(gait, side);
  const float in_air = positive(std::cos(angle + kLead_rad));
  const float knee_rad = kSoftKnee_rad + kBend_rad * gait.vigour * in_air * in_air;
  const float thigh_rad = gait.swing_rad * std::sin(angle) + kSoftKnee_rad / 2;
  const float ahead = positive(std::sin(angle)), behind = positive(-std::sin(angle));
  // Of short steps, next to nothing: the walker would stand on tiptoe.
  const float pitch_rad = gait.vigour * gait.vigour *
                          (kToeUp_rad * ahead * ahead * ahead - kToeDown_rad * behind * behind * behind);
  const Vector3f along(std::cos(pitch_rad), 0, std::sin(pitch_rad));
  const Vector3f sole = figure.ankle_m() * Vector3f(std::sin(pitch_rad), 0, -std::cos(pitch_rad));
  Leg leg;
  leg.hip = R * Vector3f(0, side_sign(side) * kHipWidth * figure.height_m, 0);
  leg.knee = leg.hip + figure.thigh_m() * (R * downwards(thigh_rad));
  leg.ankle = leg.knee + figure.shank_m() * (R * downwards(thigh_rad - knee_rad));
  leg.heel = leg.ankle + R * (sole - kBehindAnkle * figure.foot_m() * along);
  leg.toe = leg.ankle + R * (sole + (1 - kBehindAnkle) * figure.foot_m() * along);
  return leg;
}

Arm arm_of(const Figure& figure, const Gait& gait, size_t side, const Matrix3f& R) {
  constexpr float kShoulderWidth = 0.112F, kShoulderHeight = 0.272F;  // of the height
  constexpr float kSwing_rad = 0.5F, kBend_rad = 0.25F, kMoreBend_rad = 0.3F, kOutwards = 0.13F;
  const float opposite = -std::sin(side_angle(gait, side));
  const float upper_rad = gait.vigour * kSwing_rad * opposite;
  const float lower_rad = upper_rad + kBend_rad + gait.vigour * kMoreBend_rad * positive(opposite);
  const Vector3f outwards(0, side_sign(side) * kOutwards, 0);
  const Vector3f lower = R * (downwards(lower_rad) + 0.3F * outwards).normalized();
  Arm arm;
  arm.shoulder = R * Vector3f(0, side_sign(side) * kShoulderWidth, kShoulderHeight) * figure.height_m;
  arm.elbow = arm.shoulder + figure.upper_arm_m() * (R * (downwards(upper_rad) + outwards).normalized());
  arm.wrist = arm.elbow + figure.forearm_m() * lower;
  arm.fingertips = arm.wrist + figure.hand_m() * lower;
  return arm;
}

/// Moves the body, whose pelvis is at the origin, to where its lower sole touches the floor.
void put_on_floor(Joints& joints, const Eigen::Vector2d& at) {
  float lowest = 0;
  for (const Leg& leg : joints.legs) lowest = std::min({lowest, leg.heel.z(), leg.toe.z()});
  const Vector3f shift(static_cast<float>(at.x()), static_cast<float>(at.y()), -lowest);
  for (Vector3f* p : {&joints.pelvis, &joints.neck, &joints.head}) *p += shift;
  for (Leg& leg : joints.legs) {
    for (Vector3f* p : {&leg.hip, &leg.knee, &leg.ankle, &leg.heel, &leg.toe}) *p += shift;
  }
  for (Arm& arm : joints.arms) {
    for (Vector3f* p : {&arm.shoulder, &arm.elbow, &arm.wrist, &arm.fingertips}) *p += shift;
  }
}

}  // namespace

Joints joints_of(const Figure& figure, const WalkState& state, double time_s) {
  constexpr float kPelvisTurn_rad = 0.07F, kTrunkTurn_rad = 0.09F, kLean_rad = 0.05F;
  constexpr float kNeckToHead = 0.105F;  // of the height
  const Gait gait = gait_of(figure, state);
  const Matrix3f R = AngleAxisf(static_cast<float>(state.heading_rad), Vector3f::UnitZ()).toRotationMatrix();
  const float turn = gait.vigour * std::sin(gait.angle_rad);
  const auto slow = [&](double rate, double amplitude) {
    return static_cast<float>(amplitude * std::sin(rate * time_s));
  };
  const AngleAxisf lean(gait.vigour * kLean_rad + slow(1.1, 0.012), Vector3f::UnitY());
  Joints joints;
  joints.R_room_pelvis = R * AngleAxisf(-kPelvisTurn_rad * turn, Vector3f::UnitZ()).toRotationMatrix();
  joints.R_room_trunk = R * AngleAxisf(kTrunkTurn_rad * turn, Vector3f::UnitZ()).toRotationMatrix() *
                        (lean * AngleAxisf(slow(0.8, 0.012), Vector3f::UnitX())).toRotationMatrix();
  joints.R_room_head = R * AngleAxisf(slow(0.9, 0.35), Vector3f::UnitZ()).toRotationMatrix();
  joints.pelvis.setZero();
  joints.neck = joints.R_room_trunk * Vector3f(0, 0, figure.trunk_m());
  joints.head = joints.neck + joints.R_room_head * Vector3f(0.012F, 0, kNeckToHead * figure.height_m);
  for (size_t side = 0; side < kSides; ++side) {
    joints.legs[side] = leg_of(figure, gait, side, joints.R_room_pelvis);
    joints.arms[side] = arm_of(figure, gait, side, joints.R_room_trunk);
  }
  put_on_floor(joints, state.position);
  return joints;
}

}  // namespace kinloop::sim
