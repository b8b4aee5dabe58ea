#pragma once
// Temporary disk space that no other process sees and that the system frees when the program ends.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace kinloop {

/// Returns TMPDIR, or /tmp. Unlike std::filesystem::temp_directory_path it does not throw if that is no
/// folder.
std::filesystem::path temporary_folder();

/// Throws InputError naming it unless TMPDIR, or /tmp, is a folder: why no file can be created there.
void require_temporary_folder();

/// Returns the descriptor of a new, already unlinked file in `folder`, or -1 with errno set on failure.
int open_anonymous_temp_file(const std::filesystem::path& folder);

/// Immutable bytes on disk, read like memory. The kernel loads a page when it is read and may drop it again.
class MappedTempFile {
 public:
  /// Stores bytes and returns where to read them; they stay there as long as the pointer lives. Throws
  /// InputError if the disk is full or no file can be mapped.
  std::shared_ptr<const uint8_t> add(std::span<const uint8_t> bytes);

  /// Drops all pages that were read; they are loaded again when needed.
  void drop_pages() const;

  [[nodiscard]] size_t size_bytes() const { return size_bytes_; }

 private:
  struct Segment;

  std::vector<std::shared_ptr<Segment>> segments_;  // only the last one has space left
  size_t size_bytes_ = 0;
};

}  // namespace kinloop
