#include "drivers/live/device_selection.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {

size_t choose_device(const std::string& camera, const std::vector<std::string>& serials,
                     const std::string& wanted, const std::string& udev_rules) {
  if (serials.empty())
    throw InputError(fmt::format("{}: no camera found; connect it to USB 3, and check the access rights ({})",
                                 camera, udev_rules));
  if (wanted.empty()) return 0;
  const auto found = std::find(serials.begin(), serials.end(), wanted);
  if (found == serials.end())
    throw InputError(fmt::format("{}: no camera with the serial number {}; there are: {}", camera, wanted,
                                 fmt::join(serials, ", ")));
  return static_cast<size_t>(found - serials.begin());
}

StreamWidths stream_widths(int width, const std::optional<RgbdCamera>& calibration) {
  StreamWidths widths{calibration ? calibration->color.width : width};
  if (calibration && calibration->depth) widths.depth = calibration->depth->width;
  return widths;
}

std::tuple<int, int, int> mode_distance(const StreamMode& mode, int width) {
  constexpr int kRateHz = 30;
  return {std::abs(mode.rate_hz - kRateHz), std::abs(mode.width - width), -mode.height};
}

}  // namespace kinloop
