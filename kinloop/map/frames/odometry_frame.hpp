#pragma once
// In: frames as they are tracked. Out: how the frame of the map has moved relative to that of the odometry.

#include <optional>

#include "kinloop/map/frames/frame_record.hpp"

namespace kinloop {

/// Accumulates what moves the camera in the map but not in the world: corrections of the map, and poses found
/// by place recognition. Both belong to map -> odom, so that odom -> camera stays continuous (REP 105). A map
/// that begins after a loss, whose relation to the one before is unknown, is taken to begin at the last pose.
class OdometryFrame {
 public:
  /// Call for every frame in order, with the map in which it was tracked.
  void update(const FrameRecord& tracked, const Map& map);

  /// T_map_odom: T_odom_camera = T_map_odom^-1 * T_world_camera has no such jumps.
  [[nodiscard]] const SE3& T_map_odom() const { return T_map_odom_; }

 private:
  void take_up_jump(const SE3& T_world_camera);

  SE3 T_map_odom_;
  std::optional<KeyframePose> latest_;  // the last pose
  SE3 T_world_latest_;                  // the same in the map as `update` saw it last
};

}  // namespace kinloop
