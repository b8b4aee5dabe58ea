#pragma once
// In: an archive that nobody vouches for. Out: its files and folders, all of them below one folder.

#include <cstdint>
#include <filesystem>
#include <string>

namespace kinloop {

/// Returns whether this build unpacks archives (libarchive).
bool archives_available();

/// Returns whether a file is an archive by the ending of its name: .zip, .r3d (of Record3D), .7z, .tar and
/// .tar compressed by gzip, bzip2, xz or zstd.
bool is_archive_name(const std::filesystem::path& file);

/// How much may be written.
struct UnpackLimit {
  uint64_t bytes;        ///< a file counts as whole blocks of the disk
  std::string exceeded;  ///< said of an archive that holds more: the reason and the remedy
};

/// What was written.
struct UnpackedFiles {
  uint64_t count = 0, bytes = 0;
};

/// Unpacks into `folder`, which is created. Leaves out what macOS adds (__MACOSX, ._NAME). Throws InputError
/// naming the file and the member if that is a link or a device, would land elsewhere, is damaged, truncated
/// or encrypted, or exceeds the limit; what was written until then stays. Throws UsageError in a build
/// without libarchive.
UnpackedFiles unpack_archive(const std::filesystem::path& file, const std::filesystem::path& folder,
                             const UnpackLimit& limit);

}  // namespace kinloop
