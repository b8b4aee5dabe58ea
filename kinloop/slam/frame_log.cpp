#include "kinloop/slam/frame_log.hpp"

namespace kinloop {

LoggedFrame log_entry(const TrackResult& result, const PreparedFrame& frame, int image_height_px) {
  LoggedFrame entry{
      frame.id, frame.stamp_ns, result.status, result.reference, result.T_reference_camera, {}, false, {}};
  const Features& features = *frame.features;
  entry.observations.reserve(result.matches.size());
  for (const auto& [landmark, feature] : result.matches) {
    LoggedObservation seen;
    seen.landmark = landmark;
    seen.pixel = features.measured_pixels[feature];
    seen.depth_m = features.measured_depths_m[feature];
    seen.sigma_px = features.sigmas_px[feature];
    seen.row = features.raw_pixels[feature].y() / static_cast<float>(image_height_px) - 0.5F;
    if (!features.inverse_depth_gradients.empty()) {
      seen.inverse_depth_gradient = features.inverse_depth_gradients[feature];
    }
    entry.observations.push_back(seen);
  }
  return entry;
}

SE3 world_pose(const LoggedFrame& entry, const Map& map) {
  return map.keyframe(entry.reference).T_world_camera * entry.T_reference_camera;
}

Trajectory trajectory_of(const FrameLog& log, const Map& map) {
  Trajectory trajectory;
  for (const LoggedFrame& entry : log) {
    if (entry.status == TrackStatus::kLost) continue;
    trajectory.push_back({entry.stamp_ns, world_pose(entry, map)});
  }
  return trajectory;
}

Trajectory keyframe_trajectory(const Map& map) {
  Trajectory trajectory;
  for (const Keyframe& keyframe : map.keyframes()) {
    trajectory.push_back({keyframe.stamp_ns, keyframe.T_world_camera});
  }
  return trajectory;
}

}  // namespace kinloop
