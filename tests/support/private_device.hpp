#pragma once
// Devices for tests: a program that replaces what it should write to must not damage those of the machine.

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include "tests/support/temp_folder.hpp"

namespace kinloop::test {

/// A disk that is always full, in the folder of the test; empty if that needs rights that are missing.
inline std::filesystem::path private_full_device(const TempFolder& folder) {
  constexpr unsigned kMemoryDevices = 1, kFull = 7;
  const auto path = folder.path() / "full";
  if (mknod(path.c_str(), S_IFCHR | 0666, makedev(kMemoryDevices, kFull)) != 0) return {};
  const int descriptor = open(path.c_str(), O_WRONLY | O_CLOEXEC);  // refused on a disk without devices
  if (descriptor < 0) return {};
  close(descriptor);
  return path;
}

/// The same as /dev/stdout.
inline std::filesystem::path private_standard_output(const TempFolder& folder) {
  auto path = folder.path() / "private_stdout";
  if (!std::filesystem::is_symlink(path)) std::filesystem::create_symlink("/proc/self/fd/1", path);
  return path;
}

}  // namespace kinloop::test
