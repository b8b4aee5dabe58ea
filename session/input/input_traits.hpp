#pragma once
// In: a source, and its first frames. Out: what the options of a run depend on.

#include <deque>
#include <optional>
#include <string>

#include "dense/options.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// What kind of input a run has.
struct InputTraits {
  std::string name;
  bool live = false;                     ///< frames arrive in real time
  DepthSensor sensor;                    ///< of its camera
  std::optional<double> near_minimum_m;  ///< of depth, see near_minimum_m; not if the user named the sensor
};

/// Returns those of `source`, which begins with `first_frames`.
InputTraits traits_of(const FrameSource& source, const std::deque<Frame>& first_frames);

/// Returns a smaller minimum if most depth of the frames lies below that of `limits`: half of the 5 %
/// quantile, which suits a near scene, such as an object at 0.2 m in front of a RealSense SR300. nullopt if
/// it does not, or if another usual depth_scale makes it the depth of a room.
std::optional<double> near_minimum_m(const std::deque<Frame>& frames, const DepthLimits& limits,
                                     double depth_scale);

}  // namespace kinloop
