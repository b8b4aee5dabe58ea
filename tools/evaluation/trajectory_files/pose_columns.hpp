#pragma once
// In: a table of numbers. Out: which of its columns hold a pose.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/evaluation/trajectory_files/number_table.hpp"
#include "tools/evaluation/trajectory_files/trajectory_file.hpp"

namespace kinloop {

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

}  // namespace kinloop
