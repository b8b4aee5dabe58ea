#include <algorithm>
#include <numbers>

#include "simulator/movers/movers.hpp"

namespace kinloop::sim {
namespace {

constexpr float kRadPerDegree = std::numbers::pi_v<float> / 180;

const DoorSwing* latest_swing(const SwingingDoor& door, double time_s) {
  const DoorSwing* latest = nullptr;
  for (const DoorSwing& swing : door.swings) {
    if (swing.begin_s <= time_s) latest = &swing;
  }
  return latest;
}

/// From the frame of a wall (x along it, y outwards, z up) to the room, and back.
Parts from_wall(const DoorPlace& place, const Parts& parts) {
  return moved(moved(parts, 0, {0, place.wall_distance_m, 0}), place.wall_yaw_rad, {0, 0, 0});
}
Primitive to_wall(const DoorPlace& place, const Primitive& part) {
  Primitive local = moved(moved(part, -place.wall_yaw_rad, {0, 0, 0}), 0, {0, -place.wall_distance_m, 0});
  local.R_room_local.setIdentity();  // but for rounding
  return local;
}

/// The part of a box of the wall within [x0, x1] and above `z0`. The texture stays where it was.
Primitive cut(const Primitive& box, float x0, float x1, float z0) {
  const float left = box.center.x() - box.half.x(), top = box.center.z() + box.half.z();
  Primitive piece = box;
  piece.center.x() = (x0 + x1) / 2;
  piece.half.x() = (x1 - x0) / 2;
  piece.center.z() = (z0 + top) / 2;
  piece.half.z() = (top - z0) / 2;
  piece.face_texture.u0 += box.face_texture.u_scale * (x0 - left);
  return piece;
}

/// The box beside and above an opening.
Parts around_opening(const Primitive& box, float x0, float x1, float height_m) {
  const float left = box.center.x() - box.half.x(), right = box.center.x() + box.half.x();
  const float bottom = box.center.z() - box.half.z(), top = box.center.z() + box.half.z();
  Parts pieces{cut(box, left, x0, bottom), cut(box, x1, right, bottom)};
  if (top > height_m) pieces.push_back(cut(box, x0, x1, height_m));
  return pieces;
}

/// Floor, walls and ceiling behind the opening, in the frame of the wall.
Parts corridor(const DoorPlace& place, FurnitureBuilder& builder) {
  constexpr float kWidth_m = 1.9F, kHeight_m = 2.4F, kNear_m = 0.1F, kFar_m = 1.8F, kThick_m = 0.05F;
  constexpr float kMiddle_m = (kNear_m + kFar_m) / 2, kDepth_m = kFar_m - kNear_m;
  const Palette& palette = builder.palette();
  const FaceTexture paint = palette.metric(Kind::kAccentWall, 4.0, builder.random());
  const FaceTexture floor = palette.metric(Kind::kFloor, 6.0, builder.random());
  const FaceTexture ceiling = palette.metric(Kind::kPlaster, 4.0, builder.random());
  Parts parts{
      make_box({0, kMiddle_m - kNear_m / 2, -kThick_m / 2}, {kWidth_m, kDepth_m + kNear_m, kThick_m}, floor),
      make_box({0, kMiddle_m, kHeight_m + kThick_m / 2}, {kWidth_m, kDepth_m, kThick_m}, ceiling),
      make_box({0, kFar_m + kThick_m / 2, kHeight_m / 2}, {kWidth_m, kThick_m, kHeight_m}, paint)};
  for (const float side : {-1.0F, 1.0F}) {
    const float x = side * (kWidth_m + kThick_m) / 2;
    parts.push_back(make_box({x, kMiddle_m, kHeight_m / 2}, {kThick_m, kDepth_m, kHeight_m}, paint));
  }
  for (const float x : {-0.3F, 0.32F}) {
    const Parts picture = moved(builder.wall_picture(0.5F, 0.65F), 0, {x, kFar_m, 1.45F});
    parts.insert(parts.end(), picture.begin(), picture.end());
  }
  return moved(std::move(parts), 0, {place.along_m, 0, 0});
}

/// A lever on a plate, over the painted one, in the frame of the wall.
Parts handle(const DoorPlace& place, FurnitureBuilder& builder) {
  constexpr float kFromMiddle = 0.38F, kHeight_m = 1.0F, kLeaf_m = 0.04F;
  const FaceTexture metal = builder.palette().metric(Kind::kMetal, 0.3, builder.random());
  const float x = place.along_m + kFromMiddle * place.width_m;
  return {make_box({x, -kLeaf_m - 0.003F, kHeight_m - 0.05F}, {0.045F, 0.006F, 0.24F}, metal),
          make_box({x, -kLeaf_m - 0.025F, kHeight_m}, {0.02F, 0.05F, 0.02F}, metal),
          make_box({x - 0.05F, -kLeaf_m - 0.05F, kHeight_m}, {0.13F, 0.016F, 0.022F}, metal)};
}

/// The next time at which the camera sees a place, if it soon does, else `time_s`.
double next_seen_s(const FloorTrack& camera, const Eigen::Vector2d& p, double time_s) {
  constexpr double kSoon_s = 8;
  const double end_s = std::min(time_s + kSoon_s, camera.seconds());
  for (double t = time_s; t < end_s; t += FloorTrack::kStep_s) {
    if (in_view(camera.at(t), p)) return t;
  }
  return time_s;
}

std::vector<DoorSwing> planned_swings(const FloorTrack& camera, const Eigen::Vector2d& p,
                                      FurnitureBuilder& builder) {
  Random& random = builder.random();
  std::vector<DoorSwing> swings;
  double time_s = random.uniform(0.5, 2);
  while (time_s < camera.seconds()) {
    const double begin_s = next_seen_s(camera, p, time_s) + random.uniform(0, 0.6);
    const float open_rad = kRadPerDegree * builder.uniform(55, 92);
    const DoorSwing opening{begin_s, random.uniform(0.9, 2.2), 0, open_rad};
    const double shut_s = begin_s + opening.seconds + random.uniform(0.4, 5);
    const DoorSwing closing{shut_s, random.uniform(0.9, 2.2), open_rad, 0};
    swings.push_back(opening);
    swings.push_back(closing);
    time_s = shut_s + closing.seconds + random.uniform(1, 5);
  }
  return swings;
}

}  // namespace

float angle_at(const SwingingDoor& door, double time_s) {
  const DoorSwing* swing = latest_swing(door, time_s);
  if (swing == nullptr) return 0;
  const auto s = static_cast<float>(std::clamp((time_s - swing->begin_s) / swing->seconds, 0.0, 1.0));
  return swing->from_rad + s * s * (3 - 2 * s) * (swing->to_rad - swing->from_rad);
}

bool is_turning(const SwingingDoor& door, double time_s) {
  const DoorSwing* swing = latest_swing(door, time_s);
  return swing != nullptr && time_s < swing->begin_s + swing->seconds;
}

Parts door_at(const SwingingDoor& door, double time_s) {
  return moved(moved(door.closed, 0, -door.hinge), angle_at(door, time_s), door.hinge);
}

SwingingDoor open_doorway(Parts& room, const DoorPlace& place, FurnitureBuilder& builder,
                          const FloorTrack& camera) {
  SwingingDoor door;
  const auto first = room.begin() + static_cast<std::ptrdiff_t>(place.first_part);
  const auto last = first + static_cast<std::ptrdiff_t>(place.part_count);
  door.closed.assign(first, last);
  room.erase(first, last);
  const Parts lever = from_wall(place, handle(place, builder));
  door.closed.insert(door.closed.end(), lever.begin(), lever.end());
  const float x0 = place.along_m - place.width_m / 2, x1 = place.along_m + place.width_m / 2;
  door.hinge = from_wall(place, {make_box({x0, 0, 0}, {1, 1, 1}, {})}).front().center;
  Parts built = corridor(place, builder);
  for (const size_t part : {place.wall_part, place.board_part}) {
    const Parts pieces = around_opening(to_wall(place, room[part]), x0, x1, place.height_m);
    room[part] = from_wall(place, {pieces.front()}).front();
    built.insert(built.end(), pieces.begin() + 1, pieces.end());
  }
  const Parts standing = from_wall(place, built);
  room.insert(room.end(), standing.begin(), standing.end());
  const Eigen::Vector2d middle = door.closed.front().center.head<2>().cast<double>();
  door.swings = planned_swings(camera, middle, builder);
  return door;
}

}  // namespace kinloop::sim
