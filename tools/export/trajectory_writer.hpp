#pragma once
// Trajectories in the format that a file's name asks for.

#include <filesystem>
#include <string>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// Writes a table with the fields of the poses of a nav_msgs/Path, atomically: one line of field names, then
/// one line per pose. Stamps are whole seconds and nanoseconds, positions metres, orientations unit
/// quaternions; `frame_id` names the frame of the poses. Non-finite poses are left out. Throws InputError on
/// failure.
void write_path_csv(const std::filesystem::path& path, const Trajectory& trajectory,
                    const std::string& frame_id);

/// Whether the name asks for KITTI format, which has a line for each frame and no time stamps.
bool is_kitti_name(const std::filesystem::path& path);

/// Throws InputError if a file in KITTI format would number poses wrongly, since some of the frames have
/// none.
void require_pose_of_each_frame(const std::filesystem::path& path, size_t poses, size_t frames);

/// Writes a table (.csv), KITTI format (.kitti) or, under any other name, TUM format with `note` as a
/// comment, for which the others have no place. Throws InputError on failure.
void write_trajectory_file(const std::filesystem::path& path, const Trajectory& trajectory,
                           const std::string& note = {});

}  // namespace kinloop
