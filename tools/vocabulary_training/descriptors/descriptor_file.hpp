#pragma once
// Descriptors of many images in one file (.kindesc), computed once and used for several trainings, or for
// more data than fits into memory. docs/method.md describes the format.

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "kinloop/core/files/text_file.hpp"
#include "tools/vocabulary_training/descriptors/training_set.hpp"

namespace kinloop {

/// Writes one image after the other; the file appears with `commit()`.
class DescriptorFileWriter {
 public:
  /// Throws InputError if the file cannot be created.
  DescriptorFileWriter(const std::filesystem::path& path, DescriptorKind kind);

  /// Appends the descriptors of an image (N x bytes of 8UC1, N may be 0).
  void append(const cv::Mat& descriptors);

  void commit();

 private:
  AtomicFile file_;
  DescriptorKind kind_;
  std::vector<uint32_t> counts_;  ///< number of descriptors per image
};

/// Such a file. Descriptors are read when they are asked for.
class DescriptorFile {
 public:
  /// Throws InputError unless the file is complete and of this format.
  explicit DescriptorFile(std::filesystem::path path);

  [[nodiscard]] DescriptorKind kind() const { return kind_; }
  [[nodiscard]] size_t images() const { return first_row_.size() - 1; }
  [[nodiscard]] size_t rows() const { return first_row_.back(); }

  /// Returns the descriptors of an image. Throws InputError if the file has been cut short since.
  [[nodiscard]] cv::Mat descriptors_of_image(size_t image);

 private:
  [[noreturn]] void fail(const std::string& what) const;
  void read(uint64_t offset, void* bytes, size_t size);

  std::filesystem::path path_;
  std::ifstream file_;
  DescriptorKind kind_ = DescriptorKind::kOrb;
  std::vector<size_t> first_row_;  ///< per image, plus an end entry
};

}  // namespace kinloop
