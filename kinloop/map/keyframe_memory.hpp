#pragma once
// In: a growing map. Out: the same map, whose oldest descriptors and patches are in a temporary file once all
// of them take more memory than a limit. They are read like memory.

#include "kinloop/core/files/anonymous_temp_file.hpp"
#include "kinloop/map/map.hpp"

namespace kinloop {

class KeyframeMemory {
 public:
  explicit KeyframeMemory(size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// Call after keyframes have been added. If the temporary file cannot be written, warns once and leaves
  /// everything in memory.
  void apply_limit(Map& map);

  /// Bytes of descriptors and patches in memory and on disk.
  [[nodiscard]] size_t bytes_in_memory() const { return bytes_in_memory_; }
  [[nodiscard]] size_t bytes_on_disk() const { return file_.size_bytes(); }

 private:
  void move_to_disk(Map& map, KeyframeId id);

  size_t limit_bytes_;
  size_t bytes_in_memory_ = 0;
  uint32_t next_counted_ = 0, next_moved_ = 0;  // keyframes
  MappedTempFile file_;
  bool failed_ = false;
};

}  // namespace kinloop
