#pragma once
// In: an MCAP file (mcap.dev/spec), whole or truncated. Out: its messages, in the order of the file.

#include "drivers/bags/message_file.hpp"

namespace kinloop {

/// Opens an MCAP file: chunks uncompressed or compressed with lz4 or zstd. Topics come from the summary at
/// its end; a file without one (truncated, or not closed) is read once to find them. Damaged chunks are
/// skipped and counted. Throws InputError if the file is not MCAP.
std::unique_ptr<MessageFile> open_mcap(const std::filesystem::path& path);

}  // namespace kinloop
