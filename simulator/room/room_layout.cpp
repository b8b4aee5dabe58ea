#include "simulator/room/room_layout.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kinloop::sim {
namespace {

constexpr float kQuarterTurn = std::numbers::pi_v<float> / 2;
constexpr float kWallThickness_m = 0.1F;
constexpr float kDoorWidth_m = 0.92F, kDoorHeight_m = 2.05F, kDoorThickness_m = 0.04F;

Eigen::AlignedBox2f footprint(const Parts& piece) {
  const Eigen::AlignedBox3f box = bounds(piece);
  return {box.min().head<2>(), box.max().head<2>()};
}

Eigen::AlignedBox2f grown(const Eigen::AlignedBox2f& box, float margin) {
  return {box.min().array() - margin, box.max().array() + margin};
}

bool overlaps(const std::vector<Eigen::AlignedBox2f>& taken, const Eigen::AlignedBox2f& box) {
  return std::any_of(taken.begin(), taken.end(), [&](const auto& other) { return other.intersects(box); });
}

}  // namespace

RoomLayout::RoomLayout(const Palette& palette, const Eigen::Vector3f& size_m, const Trajectory& path,
                       uint64_t seed, Furnishing furnishing, uint64_t floor)
    : random_(seed), builder_(palette, random_), size_m_(size_m), furnishing_(furnishing) {
  for (const StampedPose& pose : path) {
    path_.push_back(pose.T_world_camera.translation.cast<float>());
    view_.push_back(pose.T_world_camera.R().col(2).cast<float>());
  }
  for (int i = 0; i < 4; ++i) {
    const bool along_x = i % 2 == 0;
    walls_.push_back({kQuarterTurn * static_cast<float>(i),
                      along_x ? size_m.x() : size_m.y(),
                      (along_x ? size_m.y() : size_m.x()) / 2,
                      {},
                      0});
  }
  build_shell();
  add_ceiling_lamps();
  if (furnishing_ == Furnishing::kCorridor) {
    furnish_corridor();
  } else {
    furnish_room(floor > 0 ? std::optional(hash(seed, floor)) : std::nullopt);
  }
}

/// All before the pictures is the same whatever the seed of the floor.
void RoomLayout::furnish_room(std::optional<uint64_t> floor_seed) {
  const size_t first = least_viewed_wall();
  add_window(walls_[first]);
  add_door(walls_[(first + 1 + random_.index(3)) % walls_.size()]);
  for (Wall& wall : walls_) furnish_wall(wall);
  if (floor_seed) {
    furnish_viewed_areas();
    random_ = Random(*floor_seed);
  }
  for (Wall& wall : walls_) hang_pictures(wall);
  if (!floor_seed) furnish_viewed_areas();
  scatter_on_floor();
}

/// The wall for the window, which returns no depth.
size_t RoomLayout::least_viewed_wall() const {
  std::vector<float> looks(walls_.size(), 0);
  for (size_t i = 0; i < walls_.size(); ++i) {
    const Eigen::Vector3f outwards =
        Eigen::AngleAxisf(walls_[i].yaw_rad, Eigen::Vector3f::UnitZ()) * Eigen::Vector3f::UnitY();
    for (const Eigen::Vector3f& view : view_) looks[i] += std::max(0.0F, view.dot(outwards));
  }
  return static_cast<size_t>(std::min_element(looks.begin(), looks.end()) - looks.begin());
}

Parts RoomLayout::place_at_wall(const Wall& wall, Parts piece, float along_m, float z) const {
  return moved(moved(std::move(piece), 0, {along_m, wall.distance_m, z}), wall.yaw_rad, {0, 0, 0});
}

bool RoomLayout::clear_of_path(const Parts& piece, double margin_m) const {
  const auto reach_m = static_cast<float>(margin_m);
  const Eigen::AlignedBox3f box = bounds(piece);
  return std::none_of(path_.begin(), path_.end(), [&](const Eigen::Vector3f& p) {
    if (box.squaredExteriorDistance(p) > reach_m * reach_m) return false;
    return std::any_of(piece.begin(), piece.end(), [&](const Primitive& part) {
      return signed_distance_m(part, p.cast<double>()) < margin_m;
    });
  });
}

bool RoomLayout::is_free(const Parts& piece, double margin_m) const {
  const Eigen::AlignedBox2f foot = footprint(piece);
  const Eigen::Vector2f half = size_m_.head<2>() / 2;
  constexpr float kSlack = 1e-3F;
  const bool inside = (foot.max().array() < half.array() + kSlack).all() &&
                      (foot.min().array() > -half.array() - kSlack).all();
  return inside && !overlaps(footprints_, grown(foot, -kSlack)) && clear_of_path(piece, margin_m);
}

void RoomLayout::add_floor_piece(const Parts& piece) {
  footprints_.push_back(footprint(piece));
  parts_.insert(parts_.end(), piece.begin(), piece.end());
}

void RoomLayout::build_shell() {
  const Palette& palette = builder_.palette();
  const Eigen::Vector3f s = size_m_;
  constexpr float kThick = kWallThickness_m;
  const bool repeats = furnishing_ == Furnishing::kCorridor;
  const float floor_period = repeats ? kCorridorPeriod_m : std::max({s.x(), s.y(), 6.0F});
  constexpr double kWallPeriod_m = kCorridorPeriod_m;
  const FaceTexture floor = palette.metric(Kind::kFloor, floor_period, random_);
  const FaceTexture paint = palette.metric(Kind::kPlaster, kWallPeriod_m, random_);
  parts_.push_back(make_box({0, 0, -kThick / 2}, {s.x(), s.y(), kThick}, floor));
  parts_.push_back(make_box({0, 0, s.z() + kThick / 2}, {s.x(), s.y(), kThick},
                            palette.metric(Kind::kPlaster, kWallPeriod_m, random_)));
  const uint32_t accent = random_.index(4);
  constexpr float kBoardHeight = 0.09F, kBoardDepth = 0.014F;
  const FaceTexture board = palette.metric(Kind::kWood, 0.8, random_);
  for (uint32_t i = 0; i < walls_.size(); ++i) {
    FaceTexture face_texture = paint;
    face_texture.u0 = builder_.uniform(0, 1);
    if (i == accent && !repeats) face_texture = palette.metric(Kind::kAccentWall, kWallPeriod_m, random_);
    Wall& wall = walls_[i];
    wall.first_part = parts_.size();
    const Parts slab{
        make_box({0, kThick / 2, s.z() / 2}, {wall.length_m + 2 * kThick, kThick, s.z() + 2 * kThick},
                 face_texture),
        make_box({0, -kBoardDepth / 2, kBoardHeight / 2}, {wall.length_m, kBoardDepth, kBoardHeight}, board)};
    const Parts standing = place_at_wall(wall, slab, 0, 0);
    parts_.insert(parts_.end(), standing.begin(), standing.end());
  }
}

void RoomLayout::add_ceiling_lamps() {
  constexpr float kRadius = 0.22F, kHeight = 0.07F, kSpacing_m = 3.5F;
  const FaceTexture glass = builder_.palette().metric(Kind::kPlaster, 1.0, random_);
  const auto count = [&](float length_m) {
    return std::max(1, static_cast<int>(std::lround(length_m / kSpacing_m)));
  };
  const auto place = [](int i, int n, float length_m) {
    return length_m * ((static_cast<float>(i) + 0.5F) / static_cast<float>(n) - 0.5F);
  };
  const int columns = count(size_m_.x()), rows = count(size_m_.y());
  for (int i = 0; i < columns * rows; ++i) {
    const float x = place(i % columns, columns, size_m_.x()), y = place(i / columns, rows, size_m_.y());
    Primitive lamp = make_cylinder({x, y, size_m_.z() - kHeight / 2}, kRadius, kHeight, glass);
    lamp.emissive = lamp.no_depth_return = true;
    parts_.push_back(lamp);
    lights_.push_back(
        {{x, y, size_m_.z() - kHeight - 0.02F}, {kRadius, 0, 0}, {0, kRadius, 0}, {0.46F, 0.54F, 0.6F}});
  }
}

void RoomLayout::add_window(Wall& wall) {
  const Palette& palette = builder_.palette();
  const float width = builder_.uniform(1.4F, 1.8F), height = 1.3F, z = 1.62F;
  const float along = builder_.uniform(-0.25F, 0.25F) * (wall.length_m - width);
  const FaceTexture view = palette.fitted(Kind::kWindowView, random_);
  Primitive pane = with_picture(
      make_box({0, -0.015F, z}, {width, 0.03F, height}, palette.metric(Kind::kPlain, 0.5, random_)), kFront,
      view);
  pane.emissive = pane.no_depth_return = true;
  Parts window{pane, make_box({0, -0.07F, z - height / 2 - 0.02F}, {width + 0.1F, 0.14F, 0.03F},
                              palette.metric(Kind::kPlain, 0.5, random_))};
  const FaceTexture curtain = palette.metric(Kind::kFabric, 0.4, random_);
  for (const float side : {-1.0F, 1.0F}) {
    for (int fold = 0; fold < 5; ++fold) {
      const float x = side * (width / 2 + 0.03F + 0.07F * static_cast<float>(fold));
      window.push_back(make_cylinder({x, -0.06F, 1.32F}, 0.04F, 2.2F, curtain));
    }
  }
  wall.covered.push_back(
      {Eigen::Vector2f(along - width / 2 - 0.42F, 0.93F), Eigen::Vector2f(along + width / 2 + 0.42F, 2.5F)});
  const Parts hung = place_at_wall(wall, window, along, 0);
  if (clear_of_path(hung)) parts_.insert(parts_.end(), hung.begin(), hung.end());
  try_place_at_wall(wall, builder_.radiator(), along);
  const Eigen::AngleAxisf turn(wall.yaw_rad, Eigen::Vector3f::UnitZ());
  lights_.push_back({turn * Eigen::Vector3f(along, wall.distance_m - 0.2F, z),
                     turn * Eigen::Vector3f(width / 2, 0, 0),
                     {0, 0, height / 2},
                     {0.62F, 0.56F, 0.5F}});
}

Parts RoomLayout::door_leaf() {
  const Palette& palette = builder_.palette();
  const FaceTexture front = palette.fitted(Kind::kDoor, random_);
  const FaceTexture back = palette.metric(Kind::kWood, 0.8, random_);
  const Primitive leaf = make_box({0, -kDoorThickness_m / 2, kDoorHeight_m / 2},
                                  {kDoorWidth_m, kDoorThickness_m, kDoorHeight_m}, back);
  return {with_picture(leaf, kFront, front)};
}

void RoomLayout::add_door(Wall& wall) {
  const float along = builder_.uniform(-0.35F, 0.35F) * (wall.length_m - kDoorWidth_m);
  const Parts door = place_at_wall(wall, door_leaf(), along, 0);
  door_.first_part = parts_.size();
  parts_.insert(parts_.end(), door.begin(), door.end());
  // A poster, and a note by the handle.
  const float poster_x = builder_.uniform(-0.1F, 0.1F);
  const Parts poster = moved(builder_.wall_picture(0.5F, 0.62F), 0, {poster_x, -kDoorThickness_m, 1.5F});
  const float note_x = builder_.uniform(-0.2F, 0.2F);
  const Parts note = moved(builder_.wall_picture(0.3F, 0.24F), 0, {note_x, -kDoorThickness_m, 0.8F});
  for (const Parts& paper : {place_at_wall(wall, poster, along, 0), place_at_wall(wall, note, along, 0)}) {
    parts_.insert(parts_.end(), paper.begin(), paper.end());
  }
  door_.part_count = parts_.size() - door_.first_part;
  door_.wall_yaw_rad = wall.yaw_rad;
  door_.wall_distance_m = wall.distance_m;
  door_.along_m = along;
  door_.width_m = kDoorWidth_m;
  door_.height_m = kDoorHeight_m;
  door_.wall_part = wall.first_part;
  door_.board_part = wall.first_part + 1;
  wall.covered.push_back({Eigen::Vector2f(along - kDoorWidth_m / 2, 0),
                          Eigen::Vector2f(along + kDoorWidth_m / 2, kDoorHeight_m)});
  // Clearance for opening the door.
  footprints_.push_back(
      footprint(place_at_wall(wall, {make_box({0, -0.35F, 1}, {kDoorWidth_m, 0.7F, 2}, {})}, along, 0)));
}

/// A door and a notice board in each period.
void RoomLayout::line_with_doors(Wall& wall, const Parts& door, const Parts& board) {
  constexpr float kBoardHeight_m = 1.4F;
  const auto count = static_cast<int>(wall.length_m / kCorridorPeriod_m);
  for (int i = 0; i < count; ++i) {
    const float along = kCorridorPeriod_m * (static_cast<float>(i) - static_cast<float>(count - 1) / 2);
    for (const Parts& placed : {place_at_wall(wall, door, along - kCorridorPeriod_m / 4, 0),
                                place_at_wall(wall, board, along + kCorridorPeriod_m / 4, kBoardHeight_m)})
      parts_.insert(parts_.end(), placed.begin(), placed.end());
  }
}

/// The long walls repeat themselves, the ends are of their own.
void RoomLayout::furnish_corridor() {
  const Parts door = door_leaf(), board = builder_.wall_picture(0.9F, 0.7F);
  for (Wall& wall : walls_) {
    if (wall.length_m < 2 * kCorridorPeriod_m) {
      hang_pictures(wall);
    } else {
      line_with_doors(wall, door, board);
    }
  }
}

bool RoomLayout::try_place_at_wall(Wall& wall, const Parts& piece, float along_m) {
  const Eigen::AlignedBox3f box = bounds(piece);
  const Eigen::AlignedBox2f cover(Eigen::Vector2f(along_m + box.min().x(), 0),
                                  Eigen::Vector2f(along_m + box.max().x(), box.max().z()));
  const Parts standing = place_at_wall(wall, piece, along_m, 0);
  if (overlaps(wall.covered, cover) || !is_free(standing)) return false;
  wall.covered.push_back(cover);
  add_floor_piece(standing);
  return true;
}

Parts RoomLayout::wall_piece() {
  const uint32_t choice = random_.index(20);
  if (choice < 5) return builder_.bookshelf();
  if (choice < 9) return builder_.desk();
  if (choice < 13) return builder_.cupboard();
  if (choice < 14) return builder_.sofa();
  if (choice < 16) return builder_.armchair();
  if (choice < 18) return builder_.plant();
  if (choice < 19) return builder_.floor_lamp();
  return builder_.carton_stack();
}

void RoomLayout::furnish_wall(Wall& wall) {
  constexpr int kTries = 5;
  constexpr float kSkip_m = 0.25F, kMinGap_m = 0.05F, kMaxGap_m = 0.35F;
  float along = kMinGap_m - wall.length_m / 2;
  while (along < wall.length_m / 2) {
    float used = kSkip_m;
    for (int i = 0; i < kTries; ++i) {
      const Parts piece = wall_piece();
      const float half_width = bounds(piece).sizes().x() / 2;
      if (!try_place_at_wall(wall, piece, along + half_width)) continue;
      used = 2 * half_width + builder_.uniform(kMinGap_m, kMaxGap_m);
      break;
    }
    along += used;
  }
}

void RoomLayout::hang_pictures(Wall& wall) {
  const int tries = static_cast<int>(45 * wall.length_m);
  constexpr float kGap_m = 0.05F;
  for (int i = 0; i < tries; ++i) {
    const bool shelf = builder_.chance(0.12F);
    // First large ones, then smaller ones into the gaps.
    const float largest = 1.1F - 0.7F * static_cast<float>(i) / static_cast<float>(tries);
    const float width = builder_.uniform(0.22F, largest), height = width * builder_.uniform(0.65F, 1.3F);
    const Parts piece = shelf ? builder_.wall_shelf() : builder_.wall_picture(width, std::min(height, 1.1F));
    const Eigen::AlignedBox3f box = bounds(piece);
    const float along = builder_.uniform(-0.5F, 0.5F) * (wall.length_m - box.sizes().x() - 0.1F);
    const float z = builder_.uniform(0.6F, size_m_.z() - 0.5F);
    const Eigen::AlignedBox2f cover(Eigen::Vector2f(along + box.min().x(), z + box.min().z()),
                                    Eigen::Vector2f(along + box.max().x(), z + box.max().z()));
    const Parts hung = place_at_wall(wall, piece, along, z);
    const bool fits = cover.max().y() < size_m_.z() - 0.1F && cover.min().y() > 0.3F;
    if (!fits || overlaps(wall.covered, grown(cover, kGap_m)) || !clear_of_path(hung)) continue;
    wall.covered.push_back(cover);
    parts_.insert(parts_.end(), hung.begin(), hung.end());
  }
}

}  // namespace kinloop::sim
