#pragma once
// Time stamps are int64 nanoseconds everywhere; doubles lose the microseconds of Unix time.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace kinloop {

constexpr int64_t kNsPerSecond = 1'000'000'000;

/// Stamps of files and streams are at most 73 years from zero, so that a difference of two does not overflow.
constexpr int64_t kMaxStampNs = int64_t{1} << 61;

constexpr bool is_possible_stamp(int64_t stamp_ns) {
  return stamp_ns >= -kMaxStampNs && stamp_ns <= kMaxStampNs;
}

/// Returns the stamp; throws InputError if it is not possible.
int64_t checked_stamp_ns(int64_t stamp_ns);

/// Parses decimal seconds ("1305031910.765238") exactly; nullopt if the text is not a finite decimal number,
/// or not that of a possible stamp.
std::optional<int64_t> parse_stamp_ns(std::string_view seconds);

/// Formats a stamp as seconds with six decimals, as in TUM files; with more only if the stamp needs them.
std::string format_stamp(int64_t stamp_ns);

/// Whole seconds, rounded down, and the nanoseconds after them: a stamp as ROS has it.
struct SplitStamp {
  int64_t seconds = 0;
  int64_t nanoseconds = 0;  ///< from 0 to 999,999,999
};

constexpr SplitStamp split_stamp(int64_t stamp_ns) {
  const int64_t seconds = stamp_ns / kNsPerSecond - (stamp_ns % kNsPerSecond < 0 ? 1 : 0);
  return {seconds, stamp_ns - seconds * kNsPerSecond};
}

/// Converts seconds to nanoseconds, rounded.
int64_t to_ns(double seconds);

/// Converts nanoseconds to seconds.
inline double to_seconds(int64_t duration_ns) {
  return 1e-9 * static_cast<double>(duration_ns);
}

}  // namespace kinloop
