#pragma once
// What is kept of every frame: its pose relative to a keyframe and which landmarks it saw, so that its place
// in the world follows every correction and can be refined at the end.

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// A landmark as one frame saw it.
struct LoggedObservation {
  LandmarkId landmark;
  Eigen::Vector2f pixel;  ///< undistorted, as measured
  float depth_m = 0;      ///< 0 = unknown
  float sigma_px = 1;
  float row = 0;  ///< raw image row as a share of the height, -0.5 (first) to 0.5 (last)
  Eigen::Vector2f inverse_depth_gradient = Eigen::Vector2f::Zero();  ///< 1/m per px
};

struct LoggedFrame {
  FrameId frame;
  int64_t stamp_ns = 0;
  TrackStatus status = TrackStatus::kLost;
  KeyframeId reference;
  SE3 T_reference_camera;
  KeyframeId keyframe;  ///< valid where the frame became one
  bool repeat = false;  ///< the camera gave the image before, which was tracked, once more
  std::vector<LoggedObservation> observations;
  std::shared_ptr<const Features> features;  ///< of a lost frame alone: the finished map may know its place
};

using FrameLog = std::vector<LoggedFrame>;

/// The log entry of a frame.
LoggedFrame make_log_entry(const TrackResult& result, const PreparedFrame& frame, int image_height_px);

/// The log with those lost frames located that `relocalize` knows: at the end the map knows more than when
/// they came.
FrameLog relocalize_lost_frames(
    FrameLog log, int image_height_px,
    const std::function<std::optional<TrackResult>(const PreparedFrame&)>& relocalize);

/// The frame's pose, as the map stands now; the frame must not be lost.
SE3 world_pose(const LoggedFrame& entry, const Map& map);

/// The component of the map in which most frames were tracked; the oldest of equals.
uint32_t main_component(std::span<const LoggedFrame> log, const Map& map);

/// Whether the frame was tracked in that component.
bool is_tracked_in(uint32_t component, const LoggedFrame& entry, const Map& map);

/// Poses of all frames that were tracked in the main component, as the map stands now.
Trajectory trajectory_of(std::span<const LoggedFrame> log, const Map& map);

/// Poses of all keyframes of one component.
Trajectory keyframe_trajectory(const Map& map, uint32_t component);

}  // namespace kinloop
