#pragma once

#include <cmath>
#include <cstdint>

namespace kinloop {

/// Returns the light, 0 to 1, of a channel encoded in sRGB (IEC 61966-2-1): glTF and USD have linear colours.
inline double linear_color(uint8_t channel) {
  constexpr double kFull = 255;
  const double s = channel / kFull;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

}  // namespace kinloop
