#pragma once
// Whether the values of depth are those of a sensor, and in the unit that the camera states.

#include <optional>

#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/consistency/depth_levels.hpp"
#include "kinloop/sensor/consistency/input_warning.hpp"
#include "kinloop/sensor/frame.hpp"

namespace kinloop {

/// Counts the values of all depth images.
class DepthValuesCheck {
 public:
  explicit DepthValuesCheck(const RgbdCamera& camera)
      : sensor_(camera.sensor), depth_scale_(camera.depth_scale), levels_(camera.depth_scale) {}

  void observe(const Frame& frame) { levels_.add(frame.depth_m); }

  /// Returns whether depth is constant, clipped or in coarse steps.
  [[nodiscard]] std::optional<InputWarning> values() const;

  /// Returns whether the steps of depth are those of a structured-light sensor in another unit. The map
  /// cannot tell: with all depths twice as large, so are all distances.
  [[nodiscard]] std::optional<InputWarning> unit() const;

 private:
  DepthSensor sensor_;
  double depth_scale_;
  DepthLevels levels_;
};

}  // namespace kinloop
