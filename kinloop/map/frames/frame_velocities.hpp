#pragma once
// Camera velocities computed from the poses of frames.

#include <vector>

#include "kinloop/geometry/velocity.hpp"
#include "kinloop/map/frames/frame_log.hpp"

namespace kinloop {

/// Returns the velocity of frame `i` of the log, from its neighbours in time; zero if it is lost or has no
/// close neighbour.
Velocity frame_velocity(const FrameLog& log, size_t i, const Map& map);

/// Returns the velocity of every frame.
std::vector<Velocity> frame_velocities(const FrameLog& log, const Map& map);

/// Returns the velocities of the frames that became keyframes, indexed by keyframe.
std::vector<Velocity> keyframe_velocities(const FrameLog& log, const Map& map);

}  // namespace kinloop
