#pragma once
// In: the poses of frames. Out: how fast the camera moved in each, and how far that may be off.

#include <optional>
#include <vector>

#include "kinloop/optimize/moving_pose.hpp"
#include "kinloop/slam/frame_log.hpp"

namespace kinloop {

/// Velocity of every frame from its neighbours in time; zero where it is lost or has none close by.
std::vector<Velocity> frame_velocities(const FrameLog& log, const Map& map);

/// The same of the frames that became keyframes, by id.
std::vector<Velocity> keyframe_velocities(const FrameLog& log, const Map& map);

/// How far these velocities may be off where frames are so far apart that a hand changes its velocity in
/// between: as far as they differ from the mean of their neighbours. Nothing where frames come quickly.
std::optional<VelocitySigma> velocity_doubt(const FrameLog& log, const Map& map);

/// `options` with velocities free as far as they are in doubt.
BundleOptions with_velocities(BundleOptions options, const FrameLog& log, const Map& map);

}  // namespace kinloop
