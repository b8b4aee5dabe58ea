#pragma once
// One process at a time writes a file again and again.

#include <filesystem>

namespace kinloop {

/// Holds a file that may not exist yet and that is replaced when written: by flock on a file beside it, which
/// is removed at the end. File systems without flock: no lock.
class FileLock {
 public:
  /// Throws InputError naming the file if another process holds it.
  explicit FileLock(const std::filesystem::path& file);
  ~FileLock();
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  std::filesystem::path lock_;
  int descriptor_ = -1;
};

}  // namespace kinloop
