#pragma once
// Whether results can be written, found out before the work that makes them.

#include <filesystem>

namespace kinloop {

/// Throws InputError unless a file can be written at `path`: makes the folders above it that are missing, and
/// writes and removes a temporary file beside it. An empty path, an output that nobody asked for, passes.
void require_writable_file(const std::filesystem::path& path);

/// The same for files in `folder`, which is made where it is missing.
void require_writable_folder(const std::filesystem::path& folder);

}  // namespace kinloop
