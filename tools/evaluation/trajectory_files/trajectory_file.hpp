#pragma once
// In: a file of camera poses as some program writes it. Out: the poses, and what was recognised.

#include <filesystem>
#include <string>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

enum class TrajectoryFormat {
  kTum,    ///< timestamp tx ty tz qx qy qz qw
  kEuroc,  ///< timestamp in ns, tx, ty, tz, qw, qx, qy, qz, ...
  kKitti,  ///< the upper three rows of a matrix in a line, without time stamp
  kCsv     ///< columns that are named by a first line
};

/// Between the stamps that poses without stamps are given.
constexpr int64_t kNumberedStepNs = 100'000'000;

/// The poses of a file, and how it was understood.
struct TrajectoryFile {
  Trajectory poses;
  TrajectoryFormat format = TrajectoryFormat::kTum;
  bool has_stamps = true;               ///< false: poses are numbered by stamps, see kNumberedStepNs
  bool knows_quaternion_order = false;  ///< false: x y z w is assumed, for want of a hint
  std::vector<std::string> notes = {};  ///< what differs from a plain TUM file, one line each
};

/// Reads poses in TUM, EuRoC or KITTI format, or as a table with named columns (such as `export --trajectory
/// FILE.csv`), separated by blanks, commas or semicolons; stamps in s, ms, us or ns. KITTI poses get the
/// stamps of times.txt beside the file if it has as many lines. Throws InputError with file and line if a
/// line cannot be understood, if stamps repeat, or if the file holds several trajectories.
TrajectoryFile read_trajectory_file(const std::filesystem::path& path);

}  // namespace kinloop
