#pragma once
// The log of all frames. Each pose is stored relative to a keyframe, with the observed landmarks, so that it
// follows every correction of the map and can be refined at the end.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

/// The measurement of a match, kept when the images are dropped.
struct MatchMeasurement {
  Eigen::Vector2f pixel;  ///< undistorted, as measured
  float depth_m = 0;      ///< 0 = unknown
  float sigma_px = 1;
  float row = 0;  ///< raw image row relative to the height, -0.5 (first) to 0.5 (last)
  Eigen::Vector2f inverse_depth_gradient = Eigen::Vector2f::Zero();  ///< 1/m per px
};

/// A frame as the log keeps it: with the measurements of its matches instead of images.
struct LoggedFrame : EstimatedFrame {
  std::vector<MatchMeasurement> measurements;  ///< of `matches`
  bool refined = false;  ///< refined during the run, measurements dropped (see LogLimiter)
  /// Of a lost frame: its features and surfaces, to relocalize it in the final map; else null.
  std::shared_ptr<const Frame> lost;
};

/// The frames of a run in order of time, after those of loaded maps.
using FrameLog = std::vector<LoggedFrame>;

/// Takes the pose from a frame, with the landmarks that support it.
void lose(LoggedFrame& frame);

/// Returns the form of a frame in the log.
LoggedFrame log_entry(const TrackedFrame& tracked, int image_height_px);

/// Two ways to locate a lost frame in the final map.
struct FrameSearch {
  std::function<std::optional<TrackedFrame>(const Frame&)> anywhere;
  /// Near the pose of the frame before or after it.
  std::function<std::optional<TrackedFrame>(const Frame&, const FrameRecord& neighbor)> nearby;
};

/// Returns the log after another search for lost frames: the final map covers more than the map at their
/// time. Those not found anywhere are searched near the next frame, from the last frame to the first, then
/// near the previous one. Poses of frames without depth are doubtful.
FrameLog relocalize_lost_frames(FrameLog log, int image_height_px, const FrameSearch& search);

/// Returns the log after components were parted, given T_world_camera of all keyframes before: a frame whose
/// reference is not in the component of the visit in which it was tracked (that of the latest keyframe of the
/// log, or where it was relocalized) becomes relative to that keyframe. Matches of landmarks of another
/// component are dropped.
FrameLog rebased_after_split(FrameLog log, const Map& map, std::span<const SE3> T_world_keyframe_before);
std::vector<FrameRecord> rebased_after_split(std::vector<FrameRecord> frames, const Map& map,
                                             std::span<const SE3> T_world_keyframe_before);

/// Returns the map component in which most frames were tracked; on a tie the oldest.
uint32_t main_component(std::span<const LoggedFrame> log, const Map& map);

/// Whether a trajectory includes the poses of doubtful frames.
enum class DoubtfulPoses { kLeftOut, kKept };

/// Returns the poses of the frames tracked in the main component, in the current map.
Trajectory trajectory_of(std::span<const LoggedFrame> log, const Map& map,
                         DoubtfulPoses doubtful = DoubtfulPoses::kLeftOut);

/// Returns the covariance of each of those poses, see EstimatedFrame::world_covariance; nullopt if unknown.
std::vector<std::optional<Matrix6d>> covariances_of(std::span<const LoggedFrame> log, const Map& map,
                                                    DoubtfulPoses doubtful = DoubtfulPoses::kLeftOut);

/// Returns the number of doubtful poses in the main component.
long count_doubtful_poses(std::span<const LoggedFrame> log, const Map& map);

/// Returns what that trajectory's file says of doubtful poses: "12 doubtful poses left out" or "with 12
/// doubtful poses"; empty if there are none.
std::string note_on_doubtful_poses(std::span<const LoggedFrame> log, const Map& map, DoubtfulPoses doubtful);

/// Returns the poses of all keyframes of one component.
Trajectory keyframe_trajectory(const Map& map, uint32_t component);

}  // namespace kinloop
