#pragma once
// Trajectories as CSV with the fields of the poses of a nav_msgs/Path.

#include <filesystem>
#include <string>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// Writes the file atomically: one line of field names, then one line per pose. Stamps are whole seconds and
/// nanoseconds, positions metres, orientations unit quaternions; `frame_id` names the frame of the poses.
/// Non-finite poses are left out. Throws InputError on failure.
void write_path_csv(const std::filesystem::path& path, const Trajectory& trajectory,
                    const std::string& frame_id);

}  // namespace kinloop
