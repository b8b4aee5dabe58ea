#pragma once
// Memory for descriptors beyond the machine's RAM: above a limit, blocks are memory-mapped unnamed files,
// which the system caches as far as possible.

#include <filesystem>
#include <map>
#include <memory_resource>
#include <mutex>

namespace kinloop {

class ScratchMemory : public std::pmr::memory_resource {
 public:
  /// Large blocks that exceed `limit_bytes` in total are placed in `folder`.
  ScratchMemory(size_t limit_bytes, std::filesystem::path folder)
      : limit_bytes_(limit_bytes), folder_(std::move(folder)) {}

  /// Bytes currently in files.
  [[nodiscard]] size_t bytes_in_files() const;

 private:
  void* do_allocate(size_t bytes, size_t alignment) override;
  void do_deallocate(void* block, size_t bytes, size_t alignment) override;
  [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }

  size_t limit_bytes_;
  std::filesystem::path folder_;
  mutable std::mutex mutex_;  ///< several threads allocate
  size_t in_memory_ = 0;
  std::map<void*, size_t> files_;  ///< mapped blocks
};

}  // namespace kinloop
