#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulator/room/furniture.hpp"

namespace kinloop::sim {
namespace {

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

Parts lifted(Parts parts, float z) {
  return moved(std::move(parts), 0, {0, 0, z});
}

}  // namespace

Parts FurnitureBuilder::book_pile() {
  const Palette& p = *palette_;
  Random& r = *random_;
  Parts pile;
  float z = 0;
  const auto count = 1 + r.index(4);
  for (uint32_t i = 0; i < count; ++i) {
    const float thick = uniform(0.02F, 0.045F);
    const FaceTexture cover = p.fitted(chance(0.5F) ? Kind::kPicture : Kind::kLabel, r);
    Primitive book =
        with_picture(make_box({0, 0, z + thick / 2}, {0.16F, 0.22F, thick}, plain()), kTop, cover);
    pile.push_back(moved(book, uniform(-0.3F, 0.3F), {0, 0, 0}));
    z += thick;
  }
  return pile;
}

Parts FurnitureBuilder::paper_sheets() {
  const Palette& p = *palette_;
  Random& r = *random_;
  Parts sheets;
  const auto count = 1 + r.index(3);
  for (uint32_t i = 0; i < count; ++i) {
    const float z = 0.002F * static_cast<float>(i + 1);
    const FaceTexture paper = p.fitted(Kind::kPaper, r);
    const Primitive sheet = with_picture(make_box({0, 0, z / 2}, {0.21F, 0.297F, z}, plain()), kTop, paper);
    const float x = uniform(-0.04F, 0.04F), y = uniform(-0.04F, 0.04F);
    sheets.push_back(moved(sheet, uniform(-0.6F, 0.6F), {x, y, 0}));
  }
  return sheets;
}

Parts FurnitureBuilder::pen_beaker() {
  Parts pens{make_cylinder({0, 0, 0.05F}, 0.04F, 0.1F, fabric())};
  for (int i = 0; i < 4; ++i) {
    const FaceTexture paint = plain();
    const float x = uniform(-0.02F, 0.02F), y = uniform(-0.02F, 0.02F);
    Primitive pen = make_cylinder({x, y, 0.11F}, 0.005F, 0.13F, paint);
    const float axis_y = uniform(-1, 1), axis_x = uniform(-1, 1);
    const Eigen::Vector3f axis = Eigen::Vector3f(axis_x, axis_y, 0.01F).normalized();
    pen.R_room_local = Eigen::AngleAxisf(0.2F, axis).toRotationMatrix();
    pens.push_back(pen);
  }
  return pens;
}

Parts FurnitureBuilder::small_thing() {
  const Palette& p = *palette_;
  Random& r = *random_;
  switch (r.index(8)) {
    case 0: {  // a mug with a rim of another colour
      const float height = uniform(0.08F, 0.11F);
      return {make_cylinder({0, 0, height / 2}, 0.04F, height, p.fitted(Kind::kLabel, r)),
              make_box({0.05F, 0, height / 2}, {0.03F, 0.012F, 0.6F * height}, plain())};
    }
    case 1:
      return book_pile();
    case 2:
      return paper_sheets();
    case 3: {  // a carton with a label on every side
      const float height = uniform(0.08F, 0.28F), depth = uniform(0.05F, 0.14F),
                  width = uniform(0.07F, 0.18F);
      return {make_box({0, 0, height / 2}, {width, depth, height}, p.fitted(Kind::kLabel, r))};
    }
    case 4: {  // a tin
      const float height = uniform(0.09F, 0.16F);
      const FaceTexture label = p.fitted(Kind::kLabel, r);
      return {make_cylinder({0, 0, height / 2}, uniform(0.033F, 0.055F), height, label)};
    }
    case 5: {  // a picture frame leaning back
      const FaceTexture picture = p.fitted(Kind::kPicture, r), rim = wood();
      const float width = uniform(0.13F, 0.22F);
      Primitive frame = with_picture(make_box({0, 0, 0.1F}, {width, 0.015F, 0.2F}, rim), kFront, picture);
      frame.R_room_local = Eigen::AngleAxisf(-0.2F, Eigen::Vector3f::UnitX()).toRotationMatrix();
      return {frame};
    }
    case 6: {  // a ball
      const float radius = uniform(0.035F, 0.07F);
      return {make_sphere({0, 0, radius}, radius, p.fitted(chance(0.5F) ? Kind::kBall : Kind::kLabel, r))};
    }
    default:
      return pen_beaker();
  }
}

Parts FurnitureBuilder::clutter(const Eigen::AlignedBox2f& area, float z, float spacing_m) {
  Parts parts;
  constexpr float kOccupied = 0.8F;
  for (float x = area.min().x(); x <= area.max().x(); x += spacing_m) {
    for (float y = area.min().y(); y <= area.max().y(); y += spacing_m) {
      if (!chance(kOccupied)) continue;
      const float yaw = uniform(-0.7F, 0.7F);
      const Parts thing = moved(small_thing(), yaw, {x, y, z});
      parts.insert(parts.end(), thing.begin(), thing.end());
    }
  }
  return parts;
}

Parts FurnitureBuilder::plant() {
  const float radius = uniform(0.12F, 0.18F), height = uniform(0.25F, 0.36F), y = -0.4F;
  Parts parts{make_cylinder({0, y, height / 2}, radius, height, chance(0.5F) ? plain() : fabric()),
              make_cylinder({0, y, height + 0.25F}, 0.018F, 0.5F, wood())};
  constexpr int kLeaves = 34;
  for (int i = 0; i < kLeaves; ++i) {
    const float around = uniform(0, kTurn), rise = uniform(0.1F, 0.9F), reach = uniform(0.06F, 0.26F);
    const FaceTexture green = palette_->fitted(Kind::kLeaf, *random_);
    Primitive leaf = make_cylinder({reach * std::cos(around), y + reach * std::sin(around), height + rise},
                                   uniform(0.05F, 0.1F), 0.004F, green);
    leaf.R_room_local = (Eigen::AngleAxisf(around, Eigen::Vector3f::UnitZ()) *
                         Eigen::AngleAxisf(uniform(0.2F, 1.1F), Eigen::Vector3f::UnitY()))
                            .toRotationMatrix();
    parts.push_back(leaf);
  }
  return parts;
}

Parts FurnitureBuilder::floor_lamp() {
  constexpr float kAxis = -0.22F;
  const float height = uniform(1.4F, 1.6F);
  const Primitive shade = make_cylinder({0, kAxis, height}, 0.17F, 0.28F, fabric());
  const FaceTexture pole = metal();
  return {make_cylinder({0, kAxis, 0.015F}, 0.15F, 0.03F, pole),
          make_cylinder({0, kAxis, height / 2}, 0.014F, height, pole), shade};
}

Parts FurnitureBuilder::carton_stack() {
  Parts parts;
  float z = 0;
  const auto count = 1 + random_->index(3);
  for (uint32_t i = 0; i < count; ++i) {
    const float height = uniform(0.2F, 0.34F), depth = uniform(0.3F, 0.4F), width = uniform(0.32F, 0.5F);
    const Primitive box = make_box({0, 0, z + height / 2}, {width, depth, height},
                                   palette_->fitted(Kind::kCardboard, *random_));
    parts.push_back(moved(box, uniform(-0.2F, 0.2F), {0, -0.3F, 0}));
    z += height;
  }
  const float yaw = uniform(-1, 1);
  const Parts top = moved(small_thing(), yaw, {0, -0.3F, z});
  parts.insert(parts.end(), top.begin(), top.end());
  return parts;
}

Parts FurnitureBuilder::bin() {
  return {make_cylinder({0, -0.2F, 0.16F}, 0.14F, 0.32F, chance(0.5F) ? plain() : fabric())};
}

Parts FurnitureBuilder::ball() {
  const float radius = uniform(0.1F, 0.2F);
  Primitive ball = make_sphere({0, -radius, radius}, radius, palette_->fitted(Kind::kBall, *random_));
  ball.R_room_local =
      Eigen::AngleAxisf(uniform(0, kTurn), Eigen::Vector3f(1, 1, 0.3F).normalized()).toRotationMatrix();
  return {ball};
}

Parts FurnitureBuilder::radiator() {
  Parts parts;
  const FaceTexture paint = metal();
  constexpr int kRibs = 14;
  for (int i = 0; i < kRibs; ++i) {
    const float x = 0.07F * (static_cast<float>(i) - 0.5F * (kRibs - 1));
    parts.push_back(make_box({x, -0.09F, 0.4F}, {0.05F, 0.1F, 0.56F}, paint));
  }
  parts.push_back(make_cylinder({0, -0.09F, 0.15F}, 0.02F, 0.9F, paint));
  parts.back().R_room_local = Eigen::AngleAxisf(kTurn / 4, Eigen::Vector3f::UnitY()).toRotationMatrix();
  return parts;
}

Parts FurnitureBuilder::wall_shelf() {
  const float width = uniform(0.6F, 1.0F);
  Parts parts{make_box({0, -0.11F, 0}, {width, 0.22F, 0.025F}, wood())};
  const Parts row = books(-width / 2 + 0.02F, uniform(-0.1F, 0.2F), -0.2F, 0.0125F, 0.26F);
  const Parts things =
      lifted(clutter({Eigen::Vector2f(0.25F, -0.12F), Eigen::Vector2f(width / 2 - 0.06F, -0.1F)}, 0, 0.14F),
             0.0125F);
  parts.insert(parts.end(), row.begin(), row.end());
  parts.insert(parts.end(), things.begin(), things.end());
  return parts;
}

Parts FurnitureBuilder::wall_picture(float width_m, float height_m) {
  constexpr float kThick = 0.012F;
  if (chance(0.06F)) {
    const float radius = std::min(width_m, height_m) / 2;
    const FaceTexture dial = palette_->fitted(Kind::kClock, *random_);
    Primitive clock = with_picture(make_cylinder({0, 0, 0}, radius, 0.03F, plain()), kTop, dial);
    // Turns the top cap to the room with twelve o'clock up.
    clock.R_room_local = Eigen::AngleAxisf(kTurn / 4, Eigen::Vector3f::UnitX()).toRotationMatrix();
    clock.center.y() = -0.015F;
    return {clock};
  }
  const Kind kind = width_m > 0.8F && chance(0.4F) ? Kind::kWhiteboard : Kind::kPicture;
  const FaceTexture picture = palette_->fitted(kind, *random_);
  return {with_picture(make_box({0, -kThick / 2, 0}, {width_m, kThick, height_m}, plain()), kFront, picture)};
}

}  // namespace kinloop::sim
