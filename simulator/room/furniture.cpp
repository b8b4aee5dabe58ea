#include "simulator/room/furniture.hpp"

#include <algorithm>

#include "simulator/paint/paint.hpp"

namespace kinloop::sim {
namespace {

void append(Parts& parts, const Parts& more) {
  parts.insert(parts.end(), more.begin(), more.end());
}

/// Adds four legs under a rectangle of the given outer size, from the floor to `height_m`.
void add_legs(Parts& parts, float width_m, float depth_m, float height_m, float thickness_m,
              const FaceTexture& face_texture) {
  for (const float side : {-1.0F, 1.0F}) {
    for (const float y : {-thickness_m / 2, thickness_m / 2 - depth_m}) {
      const float x = side * (width_m - thickness_m) / 2;
      parts.push_back(make_box({x, y, height_m / 2}, {thickness_m, thickness_m, height_m}, face_texture));
    }
  }
}

}  // namespace

Primitive make_box(const Eigen::Vector3f& center, const Eigen::Vector3f& size_m,
                   const FaceTexture& face_texture) {
  Primitive box;
  box.center = center;
  box.half = size_m / 2;
  box.face_texture = face_texture;
  return box;
}

Primitive make_cylinder(const Eigen::Vector3f& center, float radius_m, float height_m,
                        const FaceTexture& face_texture) {
  Primitive cylinder = make_box(center, {2 * radius_m, 2 * radius_m, height_m}, face_texture);
  cylinder.shape = Shape::kCylinder;
  return cylinder;
}

Primitive make_sphere(const Eigen::Vector3f& center, float radius_m, const FaceTexture& face_texture) {
  Primitive sphere = make_box(center, Eigen::Vector3f::Constant(2 * radius_m), face_texture);
  sphere.shape = Shape::kSphere;
  return sphere;
}

Primitive with_picture(Primitive primitive, int face, const FaceTexture& picture) {
  primitive.picture_face = face;
  primitive.picture = picture;
  return primitive;
}

Parts moved(Parts parts, float yaw_rad, const Eigen::Vector3f& translation) {
  for (Primitive& part : parts) part = moved(part, yaw_rad, translation);
  return parts;
}

Eigen::AlignedBox3f bounds(const Parts& parts) {
  Eigen::AlignedBox3f box;
  for (const Primitive& part : parts) box.extend(bounds(part));
  return box;
}

void FurnitureBuilder::add_monitor(Parts& parts, float x, float z) {
  const float width = uniform(0.42F, 0.6F), height = 0.6F * width, y = uniform(-0.26F, -0.18F);
  const FaceTexture dark = metal();
  Primitive screen = with_picture(make_box({x, y, z + 0.14F + height / 2}, {width, 0.035F, height}, dark),
                                  kFront, palette_->fitted(Kind::kScreen, *random_));
  screen.emissive = true;
  parts.push_back(screen);
  parts.push_back(make_box({x, y + 0.02F, z + 0.08F}, {0.05F, 0.03F, 0.16F}, dark));
  parts.push_back(make_cylinder({x, y, z + 0.008F}, 0.11F, 0.016F, dark));
  const FaceTexture keys = palette_->fitted(Kind::kKeyboard, *random_);
  parts.push_back(
      with_picture(make_box({x, y - 0.26F, z + 0.012F}, {0.42F, 0.15F, 0.024F}, dark), kTop, keys));
}

Parts FurnitureBuilder::desk() {
  const float width = uniform(1.2F, 1.7F), depth = uniform(0.65F, 0.78F), height = uniform(0.71F, 0.76F);
  const FaceTexture top = wood();
  Parts parts{make_box({0, -depth / 2, height - 0.015F}, {width, depth, 0.03F}, top)};
  add_legs(parts, width, depth, height - 0.03F, 0.05F, metal());
  const float drawers_x = (chance(0.5F) ? 1.0F : -1.0F) * (width / 2 - 0.28F);
  parts.push_back(with_picture(make_box({drawers_x, -depth / 2, 0.34F}, {0.42F, depth - 0.08F, 0.62F}, top),
                               kFront, palette_->fitted(Kind::kDrawers, *random_)));
  const float monitor_x = uniform(-0.2F, 0.2F);
  add_monitor(parts, monitor_x, height);
  const float edge = width / 2 - 0.08F;
  append(parts, clutter({Eigen::Vector2f(-edge, 0.08F - depth), Eigen::Vector2f(monitor_x - 0.33F, -0.08F)},
                        height, 0.19F));
  append(parts, clutter({Eigen::Vector2f(monitor_x + 0.33F, 0.08F - depth), Eigen::Vector2f(edge, -0.08F)},
                        height, 0.19F));
  return parts;
}

Parts FurnitureBuilder::books(float x0, float x1, float y_front, float z, float max_height_m) {
  Parts parts;
  const FaceTexture pages = plain();
  for (float x = x0; x < x1 - 0.05F;) {
    const float width = uniform(0.022F, 0.06F), depth = uniform(0.15F, 0.21F);
    const float height = uniform(0.62F, 0.98F) * max_height_m;
    const FaceTexture spine = palette_->cell(Kind::kSpines, kSpineColumns, kSpineRows, *random_);
    Primitive book =
        with_picture(make_box({x + width / 2, y_front + depth / 2 + uniform(0, 0.025F), z + height / 2},
                              {width, depth, height}, pages),
                     kFront, spine);
    book.face_texture = book.picture;
    parts.push_back(book);
    x += width + 0.002F;
    if (chance(0.06F)) x += uniform(0.05F, 0.2F);
  }
  return parts;
}

Parts FurnitureBuilder::bookshelf() {
  const float width = uniform(0.75F, 1.1F), height = uniform(1.7F, 2.15F);
  constexpr float kDepth = 0.3F, kBoard = 0.025F;
  const FaceTexture face_texture = wood();
  Parts parts{make_box({0, -0.006F, height / 2}, {width, 0.012F, height}, face_texture)};
  for (const float side : {-1.0F, 1.0F}) {
    parts.push_back(make_box({side * (width - kBoard) / 2, -kDepth / 2, height / 2}, {kBoard, kDepth, height},
                             face_texture));
  }
  const int levels = 5;
  const float step = (height - kBoard) / levels;
  for (int level = 0; level <= levels; ++level) {
    const float z = step * static_cast<float>(level);
    parts.push_back(
        make_box({0, -kDepth / 2, z + kBoard / 2}, {width - 2 * kBoard, kDepth, kBoard}, face_texture));
    if (level == levels) break;
    const float inside = width / 2 - kBoard - 0.01F, floor = z + kBoard, room = step - kBoard - 0.02F;
    const float split = chance(0.4F) ? uniform(-0.2F, 0.2F) : inside;
    append(parts, books(-inside, split, 0.03F - kDepth, floor, std::min(room, 0.31F)));
    if (split < inside)
      append(parts, clutter({Eigen::Vector2f(split + 0.05F, -0.24F), Eigen::Vector2f(inside - 0.05F, -0.12F)},
                            floor, 0.15F));
  }
  return parts;
}

Parts FurnitureBuilder::cupboard() {
  const float width = uniform(0.7F, 1.3F), depth = uniform(0.4F, 0.48F), height = uniform(0.75F, 1.0F);
  const FaceTexture drawers = palette_->fitted(Kind::kDrawers, *random_);
  Parts parts{
      with_picture(make_box({0, -depth / 2, height / 2}, {width, depth, height}, wood()), kFront, drawers)};
  append(parts, clutter({Eigen::Vector2f(0.08F - width / 2, 0.08F - depth),
                         Eigen::Vector2f(width / 2 - 0.08F, -0.08F)},
                        height, 0.17F));
  return parts;
}

Parts FurnitureBuilder::seat(float width_m) {
  constexpr float kArm = 0.16F, kDepth = 0.82F;
  const FaceTexture cover = fabric();
  Parts parts{make_box({0, -kDepth / 2, 0.2F}, {width_m, kDepth, 0.3F}, cover),
              make_box({0, -0.1F, 0.55F}, {width_m, 0.2F, 0.42F}, cover)};
  for (const float side : {-1.0F, 1.0F}) {
    parts.push_back(
        make_box({side * (width_m - kArm) / 2, -kDepth / 2, 0.45F}, {kArm, kDepth - 0.02F, 0.24F}, cover));
  }
  const int places = width_m > 1.2F ? 3 : 1;
  const float place = (width_m - 2 * kArm) / static_cast<float>(places);
  const FaceTexture second = fabric();
  for (int i = 0; i < places; ++i) {
    const float x = kArm - width_m / 2 + place * (static_cast<float>(i) + 0.5F);
    parts.push_back(make_box({x, -0.5F, 0.4F}, {place - 0.02F, 0.6F, 0.12F}, second));
    if (chance(0.7F)) {
      const FaceTexture third = fabric();
      Primitive cushion = make_box({x + uniform(-0.1F, 0.1F), -0.3F, 0.62F}, {0.42F, 0.12F, 0.36F}, third);
      cushion.R_room_local = Eigen::AngleAxisf(-0.3F, Eigen::Vector3f::UnitX()).toRotationMatrix();
      parts.push_back(cushion);
    }
  }
  return parts;
}

Parts FurnitureBuilder::sofa() {
  return seat(uniform(1.7F, 2.0F));
}

Parts FurnitureBuilder::armchair() {
  return seat(uniform(0.85F, 0.95F));
}

Parts FurnitureBuilder::chair() {
  constexpr float kWidth = 0.44F, kDepth = 0.46F, kSeat_m = 0.45F;
  const FaceTexture frame = wood();
  Parts parts{make_box({0, -kDepth / 2, kSeat_m}, {kWidth, kDepth, 0.04F}, chance(0.5F) ? fabric() : frame)};
  add_legs(parts, kWidth, kDepth, kSeat_m - 0.02F, 0.04F, frame);
  for (const float x : {-0.2F, 0.0F, 0.2F})
    parts.push_back(make_box({x, -0.02F, 0.66F}, {0.035F, 0.03F, 0.4F}, frame));
  parts.push_back(make_box({0, -0.02F, 0.86F}, {kWidth, 0.035F, 0.1F}, frame));
  return parts;
}

Parts FurnitureBuilder::low_table() {
  const float width = uniform(0.7F, 1.0F), depth = uniform(0.45F, 0.6F), height = uniform(0.4F, 0.48F);
  const FaceTexture face_texture = wood();
  Parts parts{make_box({0, -depth / 2, height - 0.015F}, {width, depth, 0.03F}, face_texture)};
  add_legs(parts, width, depth, height - 0.03F, 0.05F, face_texture);
  append(parts, clutter({Eigen::Vector2f(0.07F - width / 2, 0.07F - depth),
                         Eigen::Vector2f(width / 2 - 0.07F, -0.07F)},
                        height, 0.17F));
  return parts;
}

}  // namespace kinloop::sim
