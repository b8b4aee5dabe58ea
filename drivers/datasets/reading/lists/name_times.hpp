#pragma once
// In: names of files. Out: the times in them, whose unit is found.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kinloop/core/time_unit.hpp"

namespace kinloop {

/// Returns the times in names of files: "1305031452.79172", "1700000000_066667000" (seconds_nanoseconds),
/// "1700000000066667" (microseconds), "20240131_120000_250", "42444946_78904.770" (after an ID) and the like,
/// with any words around them. A single file has the unit of `known`. nullopt unless all names have times
/// that differ.
std::optional<FoundTimes> times_in_names(const std::vector<std::filesystem::path>& files,
                                         const std::optional<TimeUnit>& known = {});

/// A number in a name, as it is written.
struct NameNumber {
  std::string digits;
  std::string fraction;  ///< the digits after a point; may be empty
  char before = 0;       ///< the character before it; 0: none
};

/// Returns the numbers in a name without its extension: "cam0_12.50" has 0 and 12.50.
std::vector<NameNumber> numbers_in_name(const std::filesystem::path& file);

}  // namespace kinloop
