#include "kinloop/tracking/frame_log.hpp"

#include <algorithm>

namespace kinloop {
namespace {

PreparedFrame lost_frame(const LoggedFrame& entry) {
  PreparedFrame frame;
  frame.id = entry.frame;
  frame.stamp_ns = entry.stamp_ns;
  frame.features = entry.features;
  return frame;
}

}  // namespace

LoggedFrame make_log_entry(const TrackResult& result, const PreparedFrame& frame, int image_height_px) {
  LoggedFrame entry{frame.id,
                    frame.stamp_ns,
                    result.status,
                    result.reference,
                    result.T_reference_camera,
                    {},
                    false,
                    frame.features->depth_stamp_difference_s,
                    false,
                    {},
                    {}};
  if (result.status == TrackStatus::kLost) entry.features = frame.features;
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

FrameLog relocalize_lost_frames(FrameLog log, int image_height_px, const FrameSearch& search) {
  const auto relocalize = [&](LoggedFrame& entry, const auto& find) {
    if (entry.status != TrackStatus::kLost || !entry.features) return;
    const PreparedFrame frame = lost_frame(entry);
    if (const std::optional<TrackResult> found = find(frame))
      entry = make_log_entry(*found, frame, image_height_px);
  };
  const auto search_near = [&](size_t i, size_t neighbor) {
    if (log[neighbor].status != TrackStatus::kTracked) return;
    relocalize(log[i], [&](const PreparedFrame& frame) { return search.nearby(frame, log[neighbor]); });
  };
  for (LoggedFrame& entry : log) relocalize(entry, search.anywhere);
  for (size_t i = log.size(); i-- > 1;) search_near(i - 1, i);
  for (size_t i = 1; i < log.size(); ++i) search_near(i, i - 1);
  return log;
}

SE3 world_pose(const LoggedFrame& entry, const Map& map) {
  return map.keyframe(entry.reference).T_world_camera * entry.T_reference_camera;
}

uint32_t main_component(std::span<const LoggedFrame> log, const Map& map) {
  std::vector<int> frames(map.component_count() + 1, 0);
  for (const LoggedFrame& entry : log) {
    if (entry.status != TrackStatus::kLost) ++frames[map.keyframe(entry.reference).component];
  }
  return static_cast<uint32_t>(std::max_element(frames.begin(), frames.end()) - frames.begin());
}

bool is_tracked_in(uint32_t component, const LoggedFrame& entry, const Map& map) {
  return entry.status != TrackStatus::kLost && map.keyframe(entry.reference).component == component;
}

Trajectory trajectory_of(std::span<const LoggedFrame> log, const Map& map) {
  const uint32_t component = main_component(log, map);
  Trajectory trajectory;
  for (const LoggedFrame& entry : log) {
    if (!is_tracked_in(component, entry, map)) continue;
    trajectory.push_back({entry.stamp_ns, world_pose(entry, map)});
  }
  return trajectory;
}

Trajectory keyframe_trajectory(const Map& map, uint32_t component) {
  Trajectory trajectory;
  for (const Keyframe& keyframe : map.keyframes()) {
    if (keyframe.component != component) continue;
    trajectory.push_back({keyframe.stamp_ns, keyframe.T_world_camera});
  }
  return trajectory;
}

}  // namespace kinloop
