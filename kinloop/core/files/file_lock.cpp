#include "kinloop/core/files/file_lock.hpp"

#include <cerrno>
#include <cstdint>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// FNV-1a: a name of fixed length, since that of the file may have the longest there is.
uint64_t hash_of(std::string_view text) {
  constexpr uint64_t kOffset = 0xcbf29ce484222325, kPrime = 0x100000001b3;
  uint64_t hash = kOffset;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * kPrime;
  return hash;
}

/// The file beside `file` that is locked in its place; links are followed, as they are when it is written.
std::filesystem::path lock_of(const std::filesystem::path& file) {
  std::error_code error;
  auto target = std::filesystem::weakly_canonical(file, error);
  if (error) target = std::filesystem::absolute(file);
  return target.parent_path() / fmt::format("kinloop-{:016x}.lock", hash_of(target.filename().string()));
}

/// Whether the name still belongs to the open file: another process may have removed it at its end.
bool is_at(int descriptor, const std::filesystem::path& path) {
  struct stat open_file {
  }, named{};
  return fstat(descriptor, &open_file) == 0 && lstat(path.c_str(), &named) == 0 &&
         open_file.st_dev == named.st_dev && open_file.st_ino == named.st_ino;
}

}  // namespace

FileLock::FileLock(const std::filesystem::path& file) : lock_(lock_of(file)) {
  constexpr int kTries = 10;
  constexpr mode_t kMode = 0666;
  for (int i = 0; i < kTries; ++i) {
    descriptor_ = open(lock_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, kMode);
    if (descriptor_ < 0) return;  // what cannot be written here is said when the file is
    const bool taken = flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (!taken && is_at(descriptor_, lock_)) return;
    close(descriptor_);
    descriptor_ = -1;
    if (taken) {
      throw InputError(
          fmt::format("{}: another run saves its map into this file; wait for its end or choose "
                      "another file with --save-map",
                      file.string()));
    }
  }
}

FileLock::~FileLock() {
  if (descriptor_ < 0) return;
  unlink(lock_.c_str());  // before it is released: who opens it from now on makes a new one
  close(descriptor_);
}

}  // namespace kinloop
