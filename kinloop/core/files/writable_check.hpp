#pragma once
// Checks that results can be written before the work that makes them begins.

#include <filesystem>

namespace kinloop {

/// Throws InputError unless a file can be written at `path`, see OutputFile: creates missing parent folders,
/// then writes and removes a temporary file beside it. An empty path (output not requested) passes.
void require_writable_file(const std::filesystem::path& path);

/// Same for files in `folder`, which is created if missing.
void require_writable_folder(const std::filesystem::path& folder);

}  // namespace kinloop
