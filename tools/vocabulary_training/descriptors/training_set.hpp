#pragma once
// The descriptors for training a vocabulary; each of several processes holds those of its own images.

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory_resource>
#include <mutex>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/place/vocabulary/descriptor_kind.hpp"

namespace kinloop {

struct TrainingSet {
  explicit TrainingSet(DescriptorKind kind_of_all,
                       std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : kind(kind_of_all), rows(memory), image_of(memory) {}

  /// Appends the descriptors of an image (N x bytes of 8UC1, N may be 0).
  void append(const cv::Mat& descriptors);

  [[nodiscard]] size_t size() const { return image_of.size(); }
  [[nodiscard]] std::pmr::memory_resource* memory() const { return rows.get_allocator().resource(); }

  DescriptorKind kind;
  uint32_t images = 0;                  ///< number of images with descriptors
  std::pmr::vector<uint8_t> rows;       ///< all descriptors, image by image
  std::pmr::vector<uint32_t> image_of;  ///< per descriptor; unique within a process
};

/// Collects the descriptors of each image, all of the same kind.
TrainingSet to_training_set(std::span<const cv::Mat> descriptors_of_images,
                            DescriptorKind kind = DescriptorKind::kOrb);

/// Memory for descriptors beyond the machine's RAM: above a limit, blocks are memory-mapped unnamed files,
/// which the system caches as far as possible.
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
