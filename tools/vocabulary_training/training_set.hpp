#pragma once
// The descriptors for training a vocabulary; each of several processes holds those of its own images.

#include <cstdint>
#include <memory_resource>
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

}  // namespace kinloop
