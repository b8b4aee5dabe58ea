#include "drivers/archives/unpacked_archive.hpp"

#include <fmt/format.h>

#include "drivers/archives/unpack_archive.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr double kMega = 1e6;

/// Bytes that may be written: the rest of the disk is for the results.
UnpackLimit limit_in(const fs::path& folder) {
  std::error_code unknown;
  const fs::space_info space = fs::space(folder, unknown);
  const uint64_t bytes = unknown ? 0 : static_cast<uint64_t>(space.available) / 10 * 9;
  return {bytes, fmt::format("the archive needs more than the {:.0f} MB that are free in {}; set TMPDIR to a "
                             "folder on a larger disk, or unpack it there and give the folder",
                             static_cast<double>(bytes) / kMega, folder.parent_path().string())};
}

/// "rooms" of rooms.tar.gz: layouts and cameras are told by the names of folders, too.
fs::path stem_of(const fs::path& archive) {
  fs::path stem = archive.stem();
  if (stem.extension() == ".tar") stem = stem.stem();
  return stem;
}

}  // namespace

std::optional<ArchivePath> archive_of(const fs::path& path) {
  fs::path archive = path.has_filename() ? path : path.parent_path();  // of "rooms.zip/"
  const fs::path whole = archive;
  while (archive.has_filename()) {
    std::error_code absent;
    if (is_archive_name(archive) && fs::is_regular_file(archive, absent)) {
      const fs::path inside = whole.lexically_relative(archive);
      return ArchivePath{archive, inside == "." ? fs::path() : inside};
    }
    archive = archive.parent_path();
  }
  return std::nullopt;
}

UnpackedArchive::UnpackedArchive(fs::path archive)
    : archive_(std::move(archive)), folder_(temporary_.path() / stem_of(archive_)) {
  const UnpackedFiles files = unpack_archive(archive_, folder_, limit_in(temporary_.path()));
  log::info("{}: {} files, {:.1f} MB, unpacked to {} until the end", archive_.string(), files.count,
            static_cast<double>(files.bytes) / kMega, folder_.string());
}

std::string UnpackedArchive::shown(std::string message) const {
  const std::string there = folder_.string(), given = archive_.string();
  for (size_t at = message.find(there); at != std::string::npos; at = message.find(there, at + given.size()))
    message.replace(at, there.size(), given);
  return message;
}

}  // namespace kinloop
