#pragma once
// One process at a time writes its results into a folder.

#include <filesystem>

namespace kinloop {

/// Holds the folder (flock on the folder itself: nothing is left behind, and the system releases it when the
/// process ends) and removes the temporary files that killed processes left in it. File systems without
/// flock: no lock.
class FolderLock {
 public:
  /// Throws InputError naming the folder if another process holds it.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace kinloop
