#pragma once
// In: the first frames of a source, and the limits of depth of its map. Out: limits that suit a near scene,
// such as an object at 0.2 m in front of a RealSense SR300.

#include <deque>
#include <optional>

#include "dense/options.hpp"
#include "kinloop/sensor/frame.hpp"

namespace kinloop {

/// Returns a smaller minimum if most depth of the frames lies below that of `limits`: half of the 5 %
/// quantile. nullopt if it does not, or if another usual depth_scale makes it the depth of a room.
std::optional<double> near_minimum_m(const std::deque<Frame>& frames, const DepthLimits& limits,
                                     double depth_scale);

}  // namespace kinloop
