#pragma once
// In: time stamps as text, in an unknown unit. Out: nanoseconds, and whether they are those of one
// trajectory.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kinloop {

/// A time stamp as it stands in a file.
struct StampText {
  size_t line = 0;
  std::string text;
};

/// Stamps in the order of the file.
struct StampColumn {
  std::vector<int64_t> stamps_ns;
  std::string note;  ///< if they are not in seconds
};

/// Reads the stamps as s, ms, us or ns: whole numbers whose steps, read as seconds, are no intervals of a
/// trajectory are of the smallest unit that makes them so. Throws InputError naming the line of what is no
/// stamp.
StampColumn parse_stamps(const std::vector<StampText>& texts, const std::filesystem::path& path);

/// Throws InputError if time goes back where another trajectory begins, or if more than 1 % of the stamps
/// repeat. Returns what a user should know of the order of the stamps; empty if there is nothing.
std::string check_order(const std::vector<int64_t>& stamps_ns, const std::vector<StampText>& texts,
                        const std::filesystem::path& path);

}  // namespace kinloop
