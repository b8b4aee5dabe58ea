#pragma once
// Time stamps are int64 nanoseconds everywhere; doubles lose the microseconds of Unix time.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace kinloop {

constexpr int64_t kNsPerSecond = 1'000'000'000;

/// Reads decimal seconds ("1305031910.765238") exactly; nothing when the text is not a finite decimal number.
std::optional<int64_t> parse_stamp_ns(std::string_view seconds);

/// Writes seconds with six decimals, as the TUM files have them; more only where the stamp needs them.
std::string format_stamp(int64_t stamp_ns);

/// Nanoseconds of a duration in seconds, rounded.
int64_t to_ns(double seconds);

/// Seconds of a duration in nanoseconds.
inline double to_seconds(int64_t duration_ns) {
  return 1e-9 * static_cast<double>(duration_ns);
}

}  // namespace kinloop
