#pragma once
// In: the path of a trajectory as a user gives it, a file or a folder that holds one. Out: its poses.

#include <filesystem>
#include <vector>

#include "tools/evaluation/trajectory_files/trajectory_file.hpp"

namespace kinloop {

/// Returns the files in a folder of which the functions below read one.
std::vector<std::filesystem::path> trajectories_in(const std::filesystem::path& folder);

/// Reads the file; in a folder, the trajectory that a run or another program left there. Throws InputError.
TrajectoryFile open_estimate(const std::filesystem::path& path);

/// Reads the file; in a folder, the ground truth of the run, or that of the recording, in any layout that has
/// one. Throws InputError.
TrajectoryFile open_ground_truth(const std::filesystem::path& path);

}  // namespace kinloop
