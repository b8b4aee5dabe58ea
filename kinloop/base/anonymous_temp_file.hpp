#pragma once
// Temporary disk space that no other process sees and that the system frees when the program ends.

#include <filesystem>

namespace kinloop {

/// Returns the descriptor of a new, already unlinked file in `folder`, or -1 with errno set on failure.
int open_anonymous_temp_file(const std::filesystem::path& folder);

}  // namespace kinloop
