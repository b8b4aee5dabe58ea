#pragma once

#include <cmath>

namespace kinloop {

/// Returns a number with as many decimals as a text needs, to keep it short: a multiple of 1 / `steps`.
inline double rounded_number(double value, double steps = 1e4) {
  return std::round(steps * value) / steps;
}

}  // namespace kinloop
