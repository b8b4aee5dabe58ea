#pragma once
// In: an address. Out: the file, whole, and what is in it.

#include <filesystem>
#include <string>

#include "kinloop/base/progress.hpp"

namespace kinloop {

/// Whether this build can download (curl) and unpack (archive).
bool download_available();

/// Downloads into `file`. What has come lies in FILE.part, from where a later call goes on; `file` appears
/// when it has the size that the server told. Throws InputError naming the address and what went wrong.
void download(const std::string& url, const std::filesystem::path& file, const Progress& progress);

/// Unpacks a .tgz, .tar or .zip into `folder`; entries that would land elsewhere are refused. Throws
/// InputError naming the file when it is damaged or truncated.
void unpack(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace kinloop
