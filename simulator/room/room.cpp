#include "simulator/room/room.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/random.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/movers/movers.hpp"
#include "simulator/room/room_layout.hpp"

namespace kinloop::sim {
namespace {

constexpr double kMinHeight_m = 2.8;
constexpr double kCameraHeight_m = 1.45;
constexpr double kMaxPath_m = 25;
constexpr double kMinCameraHeight_m = 0.45, kHeadRoom_m = 0.45;

/// How much room there is around the path.
struct Spacing {
  double wall_margin_m;  ///< from the path's bounding box
  double min_side_m;     ///< of the room
};

Spacing spacing_of(Furnishing furnishing) {
  switch (furnishing) {
    case Furnishing::kCorridor:
      return {0.95, 1.9};
    case Furnishing::kSpacious:
      return {2.4, 3.6};
    case Furnishing::kDense:
      break;
  }
  return {1.45, 3.6};
}

/// Pose of the room: z along `up`, walls along the world's other axes as far as these are horizontal.
SE3 place_room(const Trajectory& path, const Spacing& spacing, Eigen::Vector3d& size_m) {
  const Eigen::Quaterniond R_world_room =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), estimate_up_direction(path));
  Eigen::AlignedBox3d box;
  std::vector<double> heights;
  for (const StampedPose& pose : path) {
    const Eigen::Vector3d p = R_world_room.inverse() * pose.T_world_camera.translation;
    box.extend(p);
    heights.push_back(p.z());
  }
  if (box.sizes().maxCoeff() > kMaxPath_m) {
    throw InputError(fmt::format("the path spans {:.0f} m; the limit for simulated rooms is {:.0f} m",
                                 box.sizes().maxCoeff(), kMaxPath_m));
  }
  const double floor = std::min(median(heights) - kCameraHeight_m, box.min().z() - kMinCameraHeight_m);
  size_m = (box.sizes().array() + 2 * spacing.wall_margin_m).max(spacing.min_side_m);
  size_m.z() = std::max(kMinHeight_m, box.max().z() + kHeadRoom_m - floor);
  const Eigen::Vector3d origin(box.center().x(), box.center().y(), floor);
  return {R_world_room, R_world_room * origin};
}

/// The path in the room frame, thinned to the resolution needed for clearance and visibility.
Trajectory thinned(const Trajectory& path, const SE3& T_room_world) {
  constexpr double kStep_m = 0.02, kStep_rad = 0.03;
  Trajectory samples;
  for (const StampedPose& pose : path) {
    const SE3 T_room_camera = T_room_world * pose.T_world_camera;
    if (!samples.empty()) {
      const SE3 step = samples.back().T_world_camera.inverse() * T_room_camera;
      if (step.translation.norm() < kStep_m && step.angle_rad() < kStep_rad) continue;
    }
    samples.push_back({pose.stamp_ns, T_room_camera});
  }
  return samples;
}

/// What stands in the room of a request.
Furnishing furnishing_of(const RoomRequest& request) {
  if (request.corridor) return Furnishing::kCorridor;
  const bool spacious = request.spacious || request.movers.people > 0 || request.movers.chairs > 0;
  return spacious ? Furnishing::kSpacious : Furnishing::kDense;
}

}  // namespace

Trajectory in_room_frame(Trajectory path, const SE3& T_room_world) {
  for (StampedPose& pose : path) pose.T_world_camera = T_room_world * pose.T_world_camera;
  return path;
}

Room build_room(const Trajectory& path, const RoomRequest& request, int threads) {
  require(!path.empty(), "a room needs a path to be built around");
  Room room;
  const Furnishing furnishing = furnishing_of(request);
  room.T_world_room = place_room(path, spacing_of(furnishing), room.size_m);
  const SE3 T_room_world = room.T_world_room.inverse();
  Palette palette(hash(request.seed, 1), threads);
  const Eigen::Vector3f size_m = room.size_m.cast<float>();
  RoomLayout layout(palette, size_m, thinned(path, T_room_world), hash(request.seed, 2), furnishing,
                    request.floor);
  Parts parts = layout.release_parts();
  Movers movers;
  Wardrobe wardrobe(palette.texture_count());
  if (request.movers.any()) {
    const CameraPath camera(in_room_frame(path, T_room_world));
    movers = populate(parts, {size_m, &camera, layout.door(), &palette}, request.movers, wardrobe,
                      hash(request.seed, 3));
  }
  std::vector<Texture> textures = palette.release_textures();
  std::vector<Texture> clothes = wardrobe.release_textures();
  std::move(clothes.begin(), clothes.end(), std::back_inserter(textures));
  room.scene = std::make_unique<Scene>(std::move(parts), std::move(textures), layout.lights(), threads,
                                       std::move(movers));
  return room;
}

}  // namespace kinloop::sim
