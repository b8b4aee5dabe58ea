#pragma once
// Whether the values of depth are those of a sensor, and in the unit that the camera states.

#include <optional>

#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/frame.hpp"
#include "session/input/checks/input_warning.hpp"
#include "session/input/measures/depth_levels.hpp"
#include "session/input/measures/disparity_steps.hpp"

namespace kinloop {

/// Counts the values of depth images: of the first all, of later ones some, which repeat what those show.
class DepthValuesCheck {
 public:
  explicit DepthValuesCheck(const RgbdCamera& camera)
      : camera_(camera), levels_(camera.depth_scale), steps_(levels_.unit_m()) {}

  void observe(const Frame& frame) {
    constexpr size_t kFirst = 90, kInterval = 16;  // frames; the first ones may all have one distance
    if (frames_++ >= kFirst && frames_ % kInterval != 0) return;
    levels_.add(frame.depth_m);
    steps_.add(frame.depth_m);
  }

  /// Returns whether depth is constant, clipped or in coarse steps.
  [[nodiscard]] std::optional<InputWarning> values() const;

  /// Returns whether the steps of depth are those of a structured-light sensor in another unit. The map
  /// cannot tell: with all depths twice as large, so are all distances.
  [[nodiscard]] std::optional<InputWarning> unit() const;

 private:
  RgbdCamera camera_;
  size_t frames_ = 0;
  DepthLevels levels_;
  DisparitySteps steps_;
};

}  // namespace kinloop
