#pragma once
// In: a URL. Out: the complete file, or its unpacked content.

#include <cstdint>
#include <filesystem>
#include <string>

#include "kinloop/core/progress.hpp"

namespace kinloop {

/// Returns whether this build can download (curl) and unpack (archive).
bool download_available();

/// Downloads into `file`. Partial data is kept in FILE.part, from which a later call resumes; `file` appears
/// once it has the size reported by the server. Throws InputError naming the URL and the error.
void download(const std::string& url, const std::filesystem::path& file, const Progress& progress);

/// The largest known archives, scenes of OpenLORIS, have some 30 GB.
constexpr uint64_t kMaxUnpackedBytes = uint64_t{64} << 30;

/// Unpacks a .tgz, .tar, .zip or .7z of files and folders into `folder`; refuses links, devices and entries
/// that would land elsewhere. Throws InputError naming the file if it is damaged or truncated, or unpacks to
/// more than `max_bytes`.
void unpack(const std::filesystem::path& file, const std::filesystem::path& folder,
            uint64_t max_bytes = kMaxUnpackedBytes);

}  // namespace kinloop
