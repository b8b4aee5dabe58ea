#include "kinloop/map/frames/odometry_frame.hpp"

namespace kinloop {

void OdometryFrame::update(const FrameRecord& tracked, const Map& map) {
  // Also at a frame without a pose: what has been added must not be added again.
  if (latest_) take_up_jump(latest_->world(map));
  if (tracked.is_lost()) return;
  const SE3 T_world_camera = tracked.world(map);
  const bool continues = latest_ && tracked.outcome == TrackingOutcome::kTracked &&
                         is_tracked_in(map.keyframe(latest_->reference).component, tracked, map);
  if (latest_ && !continues) take_up_jump(T_world_camera);
  latest_ = tracked;
  T_world_latest_ = T_world_camera;
}

/// The latest pose has become `T_world_camera`, although the camera has not moved.
void OdometryFrame::take_up_jump(const SE3& T_world_camera) {
  T_map_odom_ = T_world_camera * T_world_latest_.inverse() * T_map_odom_;
  T_world_latest_ = T_world_camera;
}

}  // namespace kinloop
