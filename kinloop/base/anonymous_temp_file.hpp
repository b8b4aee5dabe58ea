#pragma once
// Room on disk that nobody else can see and that is freed whatever happens to the program.

#include <filesystem>

namespace kinloop {

/// The descriptor of a new file in `folder` that no longer has a name; -1, with errno set, when there can be
/// none.
int open_anonymous_temp_file(const std::filesystem::path& folder);

}  // namespace kinloop
