#pragma once
// In: a URL. Out: the complete file, or its unpacked content.

#include <filesystem>
#include <string>

#include "kinloop/core/progress.hpp"

namespace kinloop {

/// Returns whether this build can download (curl) and unpack (archive).
bool download_available();

/// Downloads into `file`. Partial data is kept in FILE.part, from which a later call resumes; `file` appears
/// once it has the size reported by the server. Throws InputError naming the URL and the error.
void download(const std::string& url, const std::filesystem::path& file, const Progress& progress);

/// Unpacks a .tgz, .tar or .zip into `folder`; refuses entries that would land elsewhere. Throws InputError
/// naming the file if it is damaged or truncated.
void unpack(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace kinloop
