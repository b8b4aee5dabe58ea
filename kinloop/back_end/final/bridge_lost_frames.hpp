#pragma once
// Gives poses to frames that no measurement holds: between good ones, the camera has not gone far.

#include "kinloop/map/frames/frame_log.hpp"

namespace kinloop {

/// Returns the log with poses for lost frames between two located ones of one component that are at most 3 s
/// apart. They are doubtful, and their covariance tells how far the camera may have gone meanwhile, given how
/// it moves elsewhere in the log (see bridge_motion). Frames before `first` are left as they are.
FrameLog bridge_lost_frames(FrameLog log, size_t first, const Map& map);

}  // namespace kinloop
