#pragma once
// Memory for more descriptors than the machine has memory for: beyond a limit, blocks are files without a
// name mapped into memory, of which the system keeps what fits.

#include <filesystem>
#include <map>
#include <memory_resource>
#include <mutex>

namespace kinloop {

class ScratchMemory : public std::pmr::memory_resource {
 public:
  /// Large blocks that would take more than `limit_bytes` together lie in `folder`.
  ScratchMemory(size_t limit_bytes, std::filesystem::path folder)
      : limit_bytes_(limit_bytes), folder_(std::move(folder)) {}

  /// What lies in files now.
  [[nodiscard]] size_t bytes_in_files() const;

 private:
  void* do_allocate(size_t bytes, size_t alignment) override;
  void do_deallocate(void* block, size_t bytes, size_t alignment) override;
  [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }

  size_t limit_bytes_;
  std::filesystem::path folder_;
  mutable std::mutex mutex_;  ///< threads allocate
  size_t in_memory_ = 0;
  std::map<void*, size_t> files_;  ///< mapped blocks
};

}  // namespace kinloop
