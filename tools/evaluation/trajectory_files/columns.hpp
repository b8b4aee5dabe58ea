#pragma once
// In: a text file of numbers. Out: its rows, and which of their columns hold stamps and poses.

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "kinloop/core/files/text_file.hpp"
#include "tools/evaluation/trajectory_files/trajectory_file.hpp"

namespace kinloop {

/// Lines of numbers, separated by blanks, commas or semicolons.
struct NumberTable {
  std::vector<std::string> names;  ///< from a comment or a first line without numbers; empty if there is none
  std::vector<TextLine> rows;      ///< without comments; may differ in length
  bool has_commas = false;         ///< or semicolons
};

/// Throws InputError if the file cannot be read or has no row.
NumberTable read_number_table(const std::filesystem::path& path);

/// Columns of a pose, from 0.
struct PoseColumns {
  size_t stamp = 0;
  std::optional<size_t> nanoseconds;       ///< of the stamp, in a column of its own
  std::array<size_t, 3> translation = {};  ///< x y z
  std::array<size_t, 4> quaternion = {};   ///< x y z w
  TrajectoryFormat format = TrajectoryFormat::kTum;
  bool knows_order = false;  ///< of the quaternion
  std::string note;          ///< what was recognised; empty for plain TUM

  /// Number of fields that a line must have at least.
  [[nodiscard]] size_t width() const;
};

/// Finds the columns by their names, else by their number and by where the unit quaternions are. Throws
/// InputError naming `path` and the first line if that does not tell.
PoseColumns find_pose_columns(const NumberTable& table, const std::filesystem::path& path);

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
