#pragma once
// In: numbers as files write them. Out: times, where they are such; the unit is found.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kinloop/core/time.hpp"

namespace kinloop {

/// A number as it is written. A fraction is kept as digits: binary fractions would lose nanoseconds.
struct DecimalNumber {
  uint64_t whole = 0;
  std::string fraction = {};  ///< the digits after the point; may be empty
};

/// How numbers tell times.
struct TimeUnit {
  int64_t ns = 0;           ///< nanoseconds of a whole one
  const char* name = "";    ///< for users: "seconds", "seconds_nanoseconds"
  bool from_clock = false;  ///< Unix time, which no counter of frames reaches
};

/// Times, one for each number, in their order.
struct FoundTimes {
  std::vector<int64_t> stamps_ns;
  TimeUnit unit;
};

/// Returns the times that numbers tell. Unix times (2001 to 2096) tell their unit by their size; those of
/// other clocks by their median interval, which is that of a camera from 0.25 to 250 Hz in one unit only.
/// nullopt for numbers of frames, and for times that no file can have.
std::optional<FoundTimes> times_of(const std::vector<DecimalNumber>& numbers);

/// Returns the times of a column of a list, which are seconds if they may be; nullopt unless all are numbers
/// of another unit.
std::optional<FoundTimes> times_not_in_seconds(const std::vector<std::string>& texts);

/// Returns the median interval of the numbers in order of size; 0 if they are all equal.
double median_interval(const std::vector<DecimalNumber>& numbers);

/// Returns the stamps in a unit; nullopt if one is not possible.
std::optional<std::vector<int64_t>> stamps_in(const TimeUnit& unit,
                                              const std::vector<DecimalNumber>& numbers);

/// Returns whether a number is a second of Unix time from 2001 to 2096.
bool is_unix_second(uint64_t seconds);

/// Parses digits with or without a point and more digits; nullopt for anything else.
std::optional<DecimalNumber> parse_decimal(std::string_view text);

/// Parses digits; nullopt for anything else.
std::optional<uint64_t> parse_whole(std::string_view digits);

constexpr TimeUnit kSecondsUnit{kNsPerSecond, "seconds"};

}  // namespace kinloop
