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

/// The frames of a run in order of time, after those of loaded maps.
using FrameLog = std::vector<TrackedFrame>;

/// Returns the form of a frame in the log: with the measurements of its matches, without images. A lost frame
/// keeps its features.
TrackedFrame log_entry(TrackedFrame tracked, int image_height_px);

/// Two ways to locate a lost frame in the final map.
struct FrameSearch {
  std::function<std::optional<TrackedFrame>(const Frame&)> anywhere;
  /// Near the pose of the frame before or after it.
  std::function<std::optional<TrackedFrame>(const Frame&, const TrackedFrame& neighbor)> nearby;
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

/// Returns T_world_camera of the frame in the current map. The frame must not be lost.
SE3 world_pose(const TrackedFrame& entry, const Map& map);

/// Returns the map component in which most frames were tracked; on a tie the oldest.
uint32_t main_component(std::span<const TrackedFrame> log, const Map& map);

/// Returns whether the frame was tracked in that component.
bool is_tracked_in(uint32_t component, const TrackedFrame& entry, const Map& map);

/// Whether a trajectory includes the poses of doubtful frames.
enum class DoubtfulPoses { kLeftOut, kKept };

/// Returns the poses of the frames tracked in the main component, in the current map.
Trajectory trajectory_of(std::span<const TrackedFrame> log, const Map& map,
                         DoubtfulPoses doubtful = DoubtfulPoses::kLeftOut);

/// Returns the covariance of each of those poses, see TrackedFrame::world_covariance; nullopt if unknown.
std::vector<std::optional<Matrix6d>> covariances_of(std::span<const TrackedFrame> log, const Map& map,
                                                    DoubtfulPoses doubtful = DoubtfulPoses::kLeftOut);

/// Returns the number of doubtful poses in the main component.
long count_doubtful_poses(std::span<const TrackedFrame> log, const Map& map);

/// Returns what that trajectory's file says of doubtful poses: "12 doubtful poses left out" or "with 12
/// doubtful poses"; empty if there are none.
std::string note_on_doubtful_poses(std::span<const TrackedFrame> log, const Map& map, DoubtfulPoses doubtful);

/// Returns the poses of all keyframes of one component.
Trajectory keyframe_trajectory(const Map& map, uint32_t component);

}  // namespace kinloop
