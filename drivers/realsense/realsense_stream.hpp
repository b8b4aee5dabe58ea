#pragma once
// The source of a RealSense. Requires librealsense2's headers; internal to the RealSense driver and its
// tests.

#include <functional>
#include <memory>
#include <optional>

#include <librealsense2/rs.hpp>

#include "drivers/live/kinect_options.hpp"
#include "kinloop/sensor/source/frame_source.hpp"

namespace kinloop {

/// Opens the device that `find` returns, which tests replace by a software device. `find` is called at the
/// start and after the camera was unplugged; it throws InputError if there is none.
std::unique_ptr<FrameSource> open_realsense(const std::function<rs2::device()>& find,
                                            const KinectOptions& options,
                                            const std::optional<RgbdCamera>& calibration);

}  // namespace kinloop
