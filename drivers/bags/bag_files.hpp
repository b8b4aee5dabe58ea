#pragma once
// The containers of bags, one a source. Out: the messages in the order of the file.

#include "drivers/bags/message_file.hpp"

namespace kinloop {

/// Opens a ROS 1 bag (wiki.ros.org/Bags/Format/2.0), with or without an index; chunks uncompressed or
/// compressed with lz4 or bz2. A bag without an index (truncated, or not closed) is read once to find its
/// topics. Damaged chunks are skipped and counted. Throws InputError if the file is not a bag.
std::unique_ptr<MessageFile> open_ros1_bag(const std::filesystem::path& path);

/// Opens an MCAP file (mcap.dev/spec): chunks uncompressed or compressed with lz4 or zstd. Topics come from
/// the summary at its end; a file without one (truncated, or not closed) is read once to find them. Damaged
/// chunks are skipped and counted. Throws InputError if the file is not MCAP.
std::unique_ptr<MessageFile> open_mcap(const std::filesystem::path& path);

/// Opens a .db3 file of rosbag2 (SQLite); its messages may be compressed with zstd. Throws InputError if the
/// file is not such a bag; a damaged one is read up to the damage.
std::unique_ptr<MessageFile> open_sqlite_bag(const std::filesystem::path& path);

/// Returns whether the folder contains metadata.yaml of rosbag2, or else .mcap or .db3 files.
bool is_ros2_bag_folder(const std::filesystem::path& folder);

/// Opens the files listed in metadata.yaml, in their order; without it (the recorder was killed) all .mcap or
/// .db3 files by name. Throws InputError naming file and remedy.
std::unique_ptr<MessageFile> open_ros2_folder(const std::filesystem::path& folder);

}  // namespace kinloop
