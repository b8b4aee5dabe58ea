#pragma once
// In: the covariances of a trajectory's poses. Out: covariances.txt.

#include <filesystem>
#include <optional>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// One for each pose, of (translation; rotation) in camera axes; nullopt if unknown.
using TrajectoryCovariances = std::vector<std::optional<Matrix6d>>;

/// Writes a line per pose: its stamp as in a TUM trajectory, then the upper triangle, row by row, NaN if
/// unknown, after a comment that says so. Atomic. Throws InputError if it cannot be written, and
/// std::logic_error unless there are as many covariances as poses.
void write_covariances(const std::filesystem::path& path, const Trajectory& trajectory,
                       const TrajectoryCovariances& covariances);

}  // namespace kinloop
