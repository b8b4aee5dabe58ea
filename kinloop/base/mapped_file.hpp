#pragma once
// A file as memory: opened at once whatever its size, read page by page when it is looked at.

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace kinloop {

/// Read only. The file may be replaced by another meanwhile (AtomicFile), but must not be cut.
class MappedFile {
 public:
  /// Throws InputError when it cannot be read.
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
