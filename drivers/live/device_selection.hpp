#pragma once
// In: the devices that are connected, and the modes of one. Out: which to use.

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

/// Returns the index of the device with the serial number `wanted`, or the first one if that is empty. Throws
/// InputError that names `camera` if there is none; `udev_rules` says whose give access.
size_t choose_device(const std::string& camera, const std::vector<std::string>& serials,
                     const std::string& wanted, const std::string& udev_rules);

/// Widths of the images to be chosen, px.
struct StreamWidths {
  int color = 0;
  int depth = 848;  ///< at which a RealSense D4xx and a Gemini measure best
};

/// Returns the widths of the calibration if given, else `width` for colour.
StreamWidths stream_widths(int width, const std::optional<RgbdCamera>& calibration);

/// Size and rate of a camera's images.
struct StreamMode {
  int width = 0, height = 0;  ///< px
  int rate_hz = 0;
};

/// Orders modes: the smallest is nearest to 30 Hz, then to `width`, then has the most rows.
std::tuple<int, int, int> mode_distance(const StreamMode& mode, int width);

}  // namespace kinloop
