#pragma once
// Descriptors of many images in one file (.kindesc), to be described once and trained on often, or in more
// pieces than fit into memory. The format is described in docs/place.md.

#include <filesystem>
#include <vector>

#include "kinloop/base/mapped_file.hpp"
#include "kinloop/base/text_file.hpp"
#include "tools/vocabulary_training/training_set.hpp"

namespace kinloop {

/// Writes one image after the other; the file appears with `commit()`.
class DescriptorFileWriter {
 public:
  /// Throws InputError when the file cannot be created.
  DescriptorFileWriter(const std::filesystem::path& path, DescriptorKind kind);

  /// One more image (N x bytes of 8UC1, N may be 0).
  void append(const cv::Mat& descriptors);

  void commit();

 private:
  AtomicFile file_;
  DescriptorKind kind_;
  std::vector<uint32_t> counts_;  ///< descriptors of each image
};

/// Such a file, mapped into memory.
class DescriptorFile {
 public:
  /// Throws InputError for anything but a whole file of this format.
  explicit DescriptorFile(const std::filesystem::path& path);

  [[nodiscard]] DescriptorKind kind() const { return kind_; }
  [[nodiscard]] size_t images() const { return first_row_.size() - 1; }
  [[nodiscard]] size_t rows() const { return first_row_.back(); }

  /// The descriptors of an image, which live as long as this file.
  [[nodiscard]] cv::Mat descriptors_of_image(size_t image) const;

 private:
  MappedFile file_;
  DescriptorKind kind_ = DescriptorKind::kOrb;
  std::vector<size_t> first_row_;  ///< per image, and one more
};

}  // namespace kinloop
