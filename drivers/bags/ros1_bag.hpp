#pragma once
// In: a ROS 1 bag. Out: its messages, in order of time, via librosbag-storage (optional dependency).

#include "drivers/bags/message_file.hpp"

namespace kinloop {

/// Throws InputError if the file is not a bag or is truncated, and UsageError in a build without ROS.
std::unique_ptr<MessageFile> open_ros1_bag(const std::filesystem::path& path);

}  // namespace kinloop
