#pragma once
// In: the folder of a ROS 2 bag with metadata.yaml. Out: the messages of all its files.

#include "drivers/bags/message_file.hpp"

namespace kinloop {

/// Returns whether the folder contains metadata.yaml of rosbag2, or else .mcap or .db3 files.
bool is_ros2_bag_folder(const std::filesystem::path& folder);

/// Opens the files listed in metadata.yaml, in their order; without it (the recorder was killed) all .mcap or
/// .db3 files by name. Throws InputError naming file and remedy.
std::unique_ptr<MessageFile> open_ros2_folder(const std::filesystem::path& folder);

}  // namespace kinloop
