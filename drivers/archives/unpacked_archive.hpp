#pragma once
// An archive that is read like a folder: unpacked into a temporary one.

#include <filesystem>
#include <optional>
#include <string>

#include "kinloop/core/files/temporary_folder.hpp"

namespace kinloop {

/// A path into an archive: "rooms.zip/kitchen" is the folder kitchen in rooms.zip.
struct ArchivePath {
  std::filesystem::path archive;
  std::filesystem::path inside;  ///< empty: all of it
};

/// Returns the archive that a path is or leads into; nullopt if there is no such file.
std::optional<ArchivePath> archive_of(const std::filesystem::path& path);

/// The content of an archive, in a temporary folder that is removed with this object.
class UnpackedArchive {
 public:
  /// Unpacks, and says where to. At most nine tenths of the free disk space are taken. Throws InputError and
  /// UsageError as unpack_archive does.
  explicit UnpackedArchive(std::filesystem::path archive);

  /// The top folder, of the archive's name without its ending.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// Returns a message with paths as they are in the archive: "rooms.zip/kitchen/rgb.txt".
  [[nodiscard]] std::string shown(std::string message) const;

 private:
  std::filesystem::path archive_;
  TemporaryFolder temporary_;
  std::filesystem::path folder_;
};

}  // namespace kinloop
