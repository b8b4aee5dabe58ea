#pragma once
// In: a ROS 1 bag (wiki.ros.org/Bags/Format/2.0), whole or truncated. Out: its messages, in the order of the
// file.

#include "drivers/bags/message_file.hpp"

namespace kinloop {

/// Opens a bag, with or without an index; chunks uncompressed or compressed with lz4 or bz2. A bag without an
/// index (truncated, or not closed) is read once to find its topics. Damaged chunks are skipped and counted.
/// Throws InputError if the file is not a bag.
std::unique_ptr<MessageFile> open_ros1_bag(const std::filesystem::path& path);

}  // namespace kinloop
