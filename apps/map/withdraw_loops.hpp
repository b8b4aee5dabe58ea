#pragma once
// In: a saved map, and loops of it that are false. Out: the map as it would be without them.

#include <span>

#include "kinloop/loop/options.hpp"
#include "kinloop/map/saved_map.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Takes loops out of the map: splits the landmarks and parts the components that only they joined, and
/// solves the pose graph of what remains. A map file does not hold the odometry as it was before a loop bent
/// it, so the relative pose of each edge is measured anew, from the depth of one keyframe and the keypoints
/// of the other. `loops` must be loops of the map.
void withdraw_loops(SavedMap& saved, std::span<const LoopEnds> loops, const Sensor& sensor,
                    const PlaceOptions& options);

}  // namespace kinloop
