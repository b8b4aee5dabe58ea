#pragma once
// In: a URL. Out: the complete file.

#include <filesystem>
#include <string>

#include "kinloop/core/progress.hpp"

namespace kinloop {

/// Returns whether this build can download (curl) and unpack (libarchive).
bool download_available();

/// Downloads into `file`. Partial data is kept in FILE.part, from which a later call resumes; `file` appears
/// once it has the size reported by the server. Throws InputError naming the URL and the error.
void download(const std::string& url, const std::filesystem::path& file, const Progress& progress);

}  // namespace kinloop
