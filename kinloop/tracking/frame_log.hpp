#pragma once
// The log of all frames. Each pose is stored relative to a keyframe, with the observed landmarks, so that it
// follows every correction of the map and can be refined at the end.

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/tracking/local_map_tracking.hpp"

namespace kinloop {

/// A landmark observed in one frame.
struct LoggedObservation {
  LandmarkId landmark;
  Eigen::Vector2f pixel;  ///< undistorted, as measured
  float depth_m = 0;      ///< 0 = unknown
  float sigma_px = 1;
  float row = 0;  ///< raw image row relative to the height, -0.5 (first) to 0.5 (last)
  Eigen::Vector2f inverse_depth_gradient = Eigen::Vector2f::Zero();  ///< 1/m per px
};

struct LoggedFrame {
  FrameId frame;
  int64_t stamp_ns = 0;
  TrackStatus status = TrackStatus::kLost;
  KeyframeId reference;
  SE3 T_reference_camera;
  KeyframeId keyframe;                 ///< valid if the frame became a keyframe
  bool repeat = false;                 ///< the camera delivered the previous, tracked image again
  float depth_stamp_difference_s = 0;  ///< Features::depth_stamp_difference_s
  bool refined = false;                ///< refined during the run, its observations dropped (see LogLimiter)
  std::vector<LoggedObservation> observations;
  /// Set only for lost frames, to relocalize them in the final map.
  std::shared_ptr<const Features> features;
};

using FrameLog = std::vector<LoggedFrame>;

/// Returns the log entry of a frame.
LoggedFrame make_log_entry(const TrackResult& result, const PreparedFrame& frame, int image_height_px);

/// Two ways to locate a frame in the final map.
struct FrameSearch {
  std::function<std::optional<TrackResult>(const PreparedFrame&)> anywhere;
  /// Near the pose of the frame before or after it.
  std::function<std::optional<TrackResult>(const PreparedFrame&, const LoggedFrame& neighbor)> nearby;
};

/// Returns the log after another search for lost frames: the final map covers more than the map at their
/// time. Those not found anywhere are searched near the next frame, from the last frame to the first, then
/// near the previous one.
FrameLog relocalize_lost_frames(FrameLog log, int image_height_px, const FrameSearch& search);

/// Returns T_world_camera of the frame in the current map. The frame must not be lost.
SE3 world_pose(const LoggedFrame& entry, const Map& map);

/// Returns the map component in which most frames were tracked; on a tie the oldest.
uint32_t main_component(std::span<const LoggedFrame> log, const Map& map);

/// Returns whether the frame was tracked in that component.
bool is_tracked_in(uint32_t component, const LoggedFrame& entry, const Map& map);

/// Returns the poses of all frames tracked in the main component, in the current map.
Trajectory trajectory_of(std::span<const LoggedFrame> log, const Map& map);

/// Returns the poses of all keyframes of one component.
Trajectory keyframe_trajectory(const Map& map, uint32_t component);

}  // namespace kinloop
