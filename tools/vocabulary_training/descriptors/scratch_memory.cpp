#include <cerrno>
#include <numeric>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/anonymous_temp_file.hpp"
#include "tools/vocabulary_training/descriptors/training_set.hpp"

namespace kinloop {
namespace {

constexpr size_t kSmallBlock = 1 << 16;  ///< never worth a file

/// Maps an unnamed file, which disappears with the mapping.
void* map_new_file(const std::filesystem::path& folder, size_t bytes) {
  const auto fail = [&](const char* what) {
    throw InputError(fmt::format(
        "{}: {} for {:.1f} MB of descriptors: {}; name another folder with --scratch", folder.string(), what,
        static_cast<double>(bytes) * 1e-6, std::generic_category().message(errno)));
  };
  const int file = open_anonymous_temp_file(folder);
  if (file < 0) fail("cannot create a file");
  // Allocates the space now, so that a full disk is an error here and not a crash later.
  errno = posix_fallocate(file, 0, static_cast<off_t>(bytes));
  const bool full = errno != 0;
  void* block = full ? MAP_FAILED : mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  close(file);
  if (block == MAP_FAILED) fail("no room");
  return block;
}

}  // namespace

size_t ScratchMemory::bytes_in_files() const {
  const std::lock_guard lock(mutex_);
  return std::accumulate(files_.begin(), files_.end(), size_t{0},
                         [](size_t sum, const auto& file) { return sum + file.second; });
}

void* ScratchMemory::do_allocate(size_t bytes, size_t alignment) {
  const std::lock_guard lock(mutex_);
  if (bytes < kSmallBlock || in_memory_ + bytes <= limit_bytes_) {
    void* block = std::pmr::new_delete_resource()->allocate(bytes, alignment);
    in_memory_ += bytes;
    return block;
  }
  void* block = map_new_file(folder_, bytes);
  files_.emplace(block, bytes);
  return block;
}

void ScratchMemory::do_deallocate(void* block, size_t bytes, size_t alignment) {
  const std::lock_guard lock(mutex_);
  const auto file = files_.find(block);
  if (file == files_.end()) {
    std::pmr::new_delete_resource()->deallocate(block, bytes, alignment);
    in_memory_ -= bytes;
    return;
  }
  munmap(block, bytes);
  files_.erase(file);
}

}  // namespace kinloop
