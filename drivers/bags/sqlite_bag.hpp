#pragma once
// In: a .db3 file of rosbag2 (SQLite). Out: its messages, in the order in which they were recorded.

#include "drivers/bags/message_file.hpp"

namespace kinloop {

/// Opens a .db3 file; its messages may be compressed with zstd. Throws InputError if the file is not such a
/// bag; a damaged one is read up to the damage.
std::unique_ptr<MessageFile> open_sqlite_bag(const std::filesystem::path& path);

}  // namespace kinloop
