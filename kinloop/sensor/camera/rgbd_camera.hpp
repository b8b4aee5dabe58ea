#pragma once
// An RGB-D camera as `camera.yaml` describes it.

#include <optional>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/depth_sensor.hpp"

namespace kinloop {

/// The calibration of an RGB-D camera, the content of `camera.yaml`.
struct RgbdCamera {
  PinholeCamera color;
  double depth_scale = 5000;     ///< units of the depth image per metre
  double depth_shift_m = 0;      ///< added to measured depth
  double fps = 30;               ///< frames per second
  double rolling_shutter_s = 0;  ///< readout time from the first colour row to the last
  double depth_delay_s = 0;      ///< time of the depth measurement minus its stamp
  /// The depth camera, if depth is not registered to colour.
  std::optional<PinholeCamera> depth;
  SE3 T_color_depth;  ///< used only with `depth`
  DepthSensor sensor = {};
  /// The source stores depth in metres, whatever `depth_scale` is. Sources set this; camera.yaml does not.
  bool has_metric_depth = false;
};

}  // namespace kinloop
