#pragma once
// In: the poses of frames. Out: how fast the camera moved in each.

#include <vector>

#include "kinloop/optimize/bundle/sensor_model.hpp"
#include "kinloop/slam/frame_log.hpp"

namespace kinloop {

/// Velocity of every frame from its neighbours in time; zero where it is lost or has none close by.
std::vector<Velocity> frame_velocities(const FrameLog& log, const Map& map);

/// The same of the frames that became keyframes, by id.
std::vector<Velocity> keyframe_velocities(const FrameLog& log, const Map& map);

}  // namespace kinloop
