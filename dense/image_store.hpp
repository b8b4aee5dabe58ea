#pragma once
// In: colour and depth images of a run. Out: the same images at the end, when their final poses are known. In
// between they are stored compressed, colour as JPEG and depth losslessly, and spilled to a temporary file
// beyond a memory limit.

#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <vector>

#include "dense/posed_image.hpp"
#include "kinloop/sensor/images/encoded_images.hpp"

namespace kinloop {

/// Keeps blobs of bytes that are needed again later; beyond a memory limit in a temporary file.
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

class ImageStore {
 public:
  explicit ImageStore(const ImageEncoding& encoding = {}, size_t memory_limit_bytes = size_t{64} << 20)
      : encoding_(encoding), bytes_(memory_limit_bytes) {}

  /// Stores images and returns their index, counted from 0. Their depth must be in the units of this store.
  /// Throws InputError if the temporary file cannot be written.
  size_t add(const EncodedImages& images);
  size_t add(const RgbdImages& images) {
    return add(encode_images(images.color, images.depth_m, encoding_).encoded);
  }

  /// Returns the images at `index`; may be called from several threads at once while nothing is added.
  [[nodiscard]] RgbdImages load(size_t index) const { return decode_images(encoded(index), encoding_); }

  /// Returns the compressed images.
  [[nodiscard]] EncodedImages encoded(size_t index) const;

  [[nodiscard]] const ImageEncoding& encoding() const { return encoding_; }

  [[nodiscard]] size_t size() const { return sizes_.size(); }
  [[nodiscard]] size_t bytes_in_memory() const { return bytes_.bytes_in_memory(); }
  [[nodiscard]] size_t bytes_on_disk() const { return bytes_.bytes_on_disk(); }

 private:
  struct Size {
    int rows = 0, cols = 0;
    size_t color_bytes = 0;
  };

  ImageEncoding encoding_;
  std::vector<Size> sizes_;
  ByteStore bytes_;  // alternating colour and depth
};

/// The stored images of a map with their poses, and the camera that took them.
struct StoredViews {
  const ImageStore& images;
  std::span<const PosedImage> views;
  DenseCamera camera;
};

}  // namespace kinloop
