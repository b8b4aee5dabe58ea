#pragma once
// How much the poses of single frames scatter, measured by what cameras cannot do: leave their way from one
// frame to the next and come back. This is the part of an error that the keypoints of a frame share (blur,
// the rest of rolling shutter and delay, a motion that is not constant within a frame), which no residual
// shows: the pose of the frame takes it up.

#include <optional>
#include <span>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/map/frames/frame_log.hpp"

namespace kinloop {

/// Returns how far `at` is off the constant motion from `before` to `after`: x = (translation [m]; rotation
/// [rad]) in its own axes, divided such that independent errors with covariance C of all three poses give x
/// the covariance C. nullopt across a gap of more than half a second.
std::optional<Vector6d> off_constant_motion(const StampedPose& before, const StampedPose& at,
                                            const StampedPose& after);

/// Returns for each frame the covariance of x by which poses around it are off constant motion, in the
/// current map: of a keyframe over the nearest keyframes, whose poses bundle adjustment estimates in another
/// way, of other frames over the second around it. Accelerations count as errors, so it is an upper bound.
/// Zero where unknown.
std::vector<Matrix6d> pose_scatter(std::span<const LoggedFrame> log, const Map& map);

}  // namespace kinloop
