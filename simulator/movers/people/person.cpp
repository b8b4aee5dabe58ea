#include "simulator/movers/people/person.hpp"

namespace kinloop::sim {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;

/// An orientation and the place of its origin.
struct Place {
  Matrix3f R;
  Vector3f at;
};

Primitive ellipsoid(const Place& place, const Vector3f& offset, const Vector3f& half,
                    const FaceTexture& cover) {
  Primitive solid;
  solid.shape = Shape::kEllipsoid;
  solid.R_room_local = place.R;
  solid.center = place.at + place.R * offset;
  solid.half = half;
  solid.face_texture = cover;
  return solid;
}

/// A limb from joint to joint. It reaches beyond both, so that it is not pointed there.
Primitive limb(const Vector3f& a, const Vector3f& b, float radius_m, const FaceTexture& cover) {
  constexpr float kBeyond = 0.66F;  // half length, of the distance of the joints
  const Vector3f along = (a - b).normalized();
  Matrix3f R;
  R.col(2) = along;
  R.col(1) = along.cross(Vector3f::UnitX()).normalized();
  R.col(0) = R.col(1).cross(along);
  return ellipsoid({R, (a + b) / 2}, Vector3f::Zero(), {radius_m, radius_m, kBeyond * (a - b).norm()}, cover);
}

void add_trunk(Parts& parts, const Person& person, const Joints& joints) {
  const float h = person.figure.height_m / 1.75F, g = h * person.figure.girth;
  const Outfit& outfit = person.outfit;
  const Place trunk{joints.R_room_trunk, joints.pelvis};
  parts.push_back(ellipsoid({joints.R_room_pelvis, joints.pelvis}, {0, 0, 0.01F},
                            {0.12F * g, 0.17F * g, 0.15F * h}, outfit.trousers));
  parts.push_back(ellipsoid(trunk, {0.01F, 0, 0.16F * h}, {0.125F * g, 0.165F * g, 0.21F * h}, outfit.shirt));
  parts.push_back(ellipsoid(trunk, {0.005F, 0, 0.33F * h}, {0.125F * g, 0.19F * g, 0.2F * h}, outfit.shirt));
  parts.push_back(  // from shoulder to shoulder
      ellipsoid(trunk, {0, 0, 0.465F * h}, {0.085F * g, 0.225F * h, 0.065F * h}, outfit.shirt));
  if (!outfit.has_bag) return;
  Primitive bag = make_box({-0.18F * g, 0, 0.3F * h}, {0.14F, 0.28F, 0.4F}, outfit.bag);
  bag.center = trunk.at + trunk.R * bag.center;
  bag.R_room_local = trunk.R;
  parts.push_back(bag);
}

void add_head(Parts& parts, const Person& person, const Joints& joints) {
  const float h = person.figure.height_m / 1.75F;
  const Place head{joints.R_room_head, joints.head};
  const Vector3f half = h * Vector3f(0.098F, 0.078F, 0.118F);
  parts.push_back(limb(joints.head, joints.neck, 0.058F * h, person.outfit.skin));
  parts.push_back(ellipsoid(head, Vector3f::Zero(), half, person.outfit.face));
  parts.push_back(ellipsoid(head, {half.x(), 0, -0.01F}, {0.02F, 0.013F, 0.024F}, person.outfit.skin));
  parts.push_back(ellipsoid(head, h * Vector3f(-0.022F, 0, 0.028F), h * Vector3f(0.093F, 0.084F, 0.1F),
                            person.outfit.hair));
}

void add_arm(Parts& parts, const Person& person, const Arm& arm) {
  const float g = person.figure.girth;
  const Outfit& outfit = person.outfit;
  parts.push_back(limb(arm.shoulder, arm.elbow, 0.06F * g, outfit.shirt));
  parts.push_back(limb(arm.elbow, arm.wrist, 0.047F * g, outfit.short_sleeves ? outfit.skin : outfit.shirt));
  parts.push_back(limb(arm.wrist, arm.fingertips, 0.04F, outfit.skin));
}

void add_leg(Parts& parts, const Person& person, const Leg& leg, const Matrix3f& R_room_pelvis) {
  constexpr float kSole_m = 0.03F, kFootWidth_m = 0.095F;
  const float g = person.figure.girth;
  const Outfit& outfit = person.outfit;
  parts.push_back(limb(leg.hip, leg.knee, 0.1F * g, outfit.trousers));
  parts.push_back(limb(leg.knee, leg.ankle, 0.072F * g, outfit.trousers));
  Place foot;
  foot.R.col(0) = (leg.toe - leg.heel).normalized();
  foot.R.col(1) = R_room_pelvis.col(1);
  foot.R.col(2) = foot.R.col(0).cross(foot.R.col(1));
  foot.at = (leg.heel + leg.toe) / 2;
  const float length_m = (leg.toe - leg.heel).norm();
  Primitive sole =
      make_box(foot.at + kSole_m / 2 * foot.R.col(2), {length_m, kFootWidth_m, kSole_m}, outfit.shoe);
  sole.R_room_local = foot.R;
  parts.push_back(sole);
  parts.push_back(ellipsoid(foot, {0, 0, 0.048F}, {0.52F * length_m, 0.05F, 0.05F}, outfit.shoe));
}

}  // namespace

Joints joints_at(const Person& person, double time_s) {
  return joints_of(person.figure, state_at(person.walk, time_s), time_s);
}

Parts person_at(const Person& person, double time_s) {
  const Joints joints = joints_at(person, time_s);
  Parts parts;
  add_trunk(parts, person, joints);
  add_head(parts, person, joints);
  for (const Arm& arm : joints.arms) add_arm(parts, person, arm);
  for (const Leg& leg : joints.legs) add_leg(parts, person, leg, joints.R_room_pelvis);
  return parts;
}

}  // namespace kinloop::sim
