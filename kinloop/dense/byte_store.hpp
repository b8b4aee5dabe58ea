#pragma once
// In: blobs of bytes that are needed again later. Out: the same bytes. Beyond a memory limit they are spilled
// to a temporary file.

#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

namespace kinloop {

class ByteStore {
 public:
  explicit ByteStore(size_t memory_limit_bytes) : memory_limit_bytes_(memory_limit_bytes) {}

  /// Stores a blob and returns its index, counted from 0. Throws InputError if the temporary file cannot be
  /// written.
  size_t add(std::vector<uint8_t> bytes);

  /// Returns the blob at `index`; may be called from several threads at once while nothing is added.
  [[nodiscard]] std::vector<uint8_t> load(size_t index) const;

  [[nodiscard]] size_t size() const { return entries_.size(); }
  [[nodiscard]] size_t bytes_in_memory() const { return bytes_in_memory_; }
  [[nodiscard]] size_t bytes_on_disk() const { return bytes_on_disk_; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  struct Entry {
    std::vector<uint8_t> bytes;  // empty if spilled to the file
    size_t file_offset = 0, file_bytes = 0;
  };

  void spill(const std::vector<uint8_t>& bytes);

  size_t memory_limit_bytes_;
  std::vector<Entry> entries_;
  std::unique_ptr<std::FILE, CloseFile> file_;  // unnamed: the system removes it when the program ends
  size_t bytes_in_memory_ = 0;
  size_t bytes_on_disk_ = 0;
};

}  // namespace kinloop
