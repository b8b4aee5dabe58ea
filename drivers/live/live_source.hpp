#pragma once
// In: a device that passes on its images. Out: its frames, with depth registered to colour.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "drivers/live/live_frames.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// An open device.
struct LiveDevice {
  RgbdCamera camera;  ///< as far as the device knows it; with a depth camera of its own if depth is
                      ///< not registered
  std::shared_ptr<void> streams;  ///< fill the buffer of frames until they are destroyed
  std::string serial = {};        ///< number; empty if unknown
};

/// How to open a device. `open` starts the streams; it throws InputError if there is no device.
struct LiveCamera {
  std::string name;  ///< in messages
  std::function<LiveDevice(LiveFrameBuffer& frames)> open;
  double reconnect_s = 0;  ///< time to wait for an unplugged camera
  StopRequest stop = {};   ///< ends that wait
};

/// Opens the device. Its camera is `calibration` if given, else that of the device. Throws InputError if the
/// calibration is for images of another size, or lacks the camera of depth that is not registered.
std::unique_ptr<FrameSource> open_live(const LiveCamera& live, const std::optional<RgbdCamera>& calibration);

}  // namespace kinloop
