#pragma once
// Temporary files that other code opens by name, and that are gone when the program ends, however it ends.

#include <filesystem>

#include <sys/types.h>

namespace kinloop {

/// A new folder in temporary_folder(), readable by this user only, that is removed with all that is in it: by
/// the destructor, or, if the process ends before (Ctrl-C, a crash, SIGKILL), by a shell that waits for its
/// end.
class TemporaryFolder {
 public:
  /// Throws OutputError if it cannot be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  void start_remover();

  std::filesystem::path path_;
  pid_t owner_;         ///< a forked copy of the process must not remove the folder
  pid_t remover_ = -1;  ///< the shell; -1: none
  int lifeline_ = -1;   ///< pipe to the shell, which the system closes when the process ends
};

}  // namespace kinloop
