#pragma once
// A memory-mapped file: opens instantly whatever its size and reads pages on demand.

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace kinloop {

/// Read-only. The file may be replaced while it is mapped (AtomicFile), but must not be truncated.
class MappedFile {
 public:
  /// Throws InputError if the file cannot be read.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::string_view bytes() const { return {static_cast<const char*>(begin_), size_}; }

 private:
  void* begin_ = nullptr;  ///< null for an empty file
  size_t size_ = 0;
};

}  // namespace kinloop
