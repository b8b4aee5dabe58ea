#pragma once
// Stamps are float seconds in Python.

#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop::python {

/// Rounds to microseconds, which is all that a double holds of Unix time: the stamps of files come back
/// exactly. Throws UsageError for a number that is not finite or of no such time.
inline int64_t stamp_ns_of(double seconds) {
  constexpr double kMaxSeconds = 9e9;
  if (!(std::abs(seconds) < kMaxSeconds))
    throw UsageError(fmt::format("stamp {}: expected seconds", seconds));
  return std::llround(seconds * 1e6) * 1000;
}

/// Returns the double nearest to the stamp.
inline double seconds_of(int64_t stamp_ns) {
  return static_cast<double>(stamp_ns) / static_cast<double>(kNsPerSecond);
}

}  // namespace kinloop::python
