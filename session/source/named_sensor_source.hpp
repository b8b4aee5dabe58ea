#pragma once
// In: a source, and the depth sensor that the user names. Out: its frames, as of that sensor.

#include <memory>
#include <optional>
#include <utility>

#include "kinloop/sensor/source/forwarding_source.hpp"

namespace kinloop {

/// A source whose camera has the depth sensor that the user names, whatever the recording says.
class NamedSensorSource : public ForwardingSource {
 public:
  /// Throws std::logic_error for a null pointer.
  NamedSensorSource(std::unique_ptr<FrameSource> source, DepthSensorModel model)
      : ForwardingSource(std::move(source)), camera_(ForwardingSource::camera()) {
    camera_.sensor = depth_sensor(model, SensorOrigin::kCameraFile);
  }

  std::optional<Frame> next() override { return source().next(); }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }

 private:
  RgbdCamera camera_;
};

}  // namespace kinloop
