#pragma once
// In: colour and depth images of a run. Out: the same images at the end, when their final poses are known. In
// between they are stored compressed, colour as JPEG and depth losslessly, and spilled to a temporary file
// beyond a memory limit.

#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/sensor/images/color_image.hpp"

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

struct ImageStoreOptions {
  double depth_scale = 5000;  ///< units per metre of stored depth, as those of the camera
  int jpeg_quality = 95;
  size_t memory_limit_bytes = size_t{64} << 20;
};

/// A colour image and its depth.
struct RgbdImages {
  cv::Mat color;    ///< 8UC3, BGR
  cv::Mat depth_m;  ///< 32FC1, 0 = unknown
};

/// Compressed images: colour as JPEG, depth by `pack_depth`.
struct EncodedImages {
  int rows = 0, cols = 0;
  std::vector<uint8_t> color;
  std::vector<uint8_t> depth;

  bool operator==(const EncodedImages&) const = default;
};

/// Compressed images, and what decoding them gives.
struct StoredImages {
  EncodedImages encoded;
  RgbdImages decoded;
};

/// Compresses images. Colour that came as JPEG stays as it is. Depth is rounded to the units of
/// `options.depth_scale`; values out of their range become unknown.
StoredImages encode_images(const ColorImage& color, const cv::Mat& depth_m, const ImageStoreOptions& options);
/// Images that are damaged are black and of unknown depth.
RgbdImages decode_images(const EncodedImages& images, const ImageStoreOptions& options);

/// Returns whether the size of compressed images is that in the header of their colour, and their depth can
/// be unpacked.
bool is_decodable(const EncodedImages& images);

class ImageStore {
 public:
  explicit ImageStore(const ImageStoreOptions& options = {})
      : options_(options), bytes_(options.memory_limit_bytes) {}

  /// Stores images and returns their index, counted from 0. Their depth must be in the units of this store.
  /// Throws InputError if the temporary file cannot be written.
  size_t add(const EncodedImages& images);
  size_t add(const RgbdImages& images) {
    return add(encode_images(images.color, images.depth_m, options_).encoded);
  }

  /// Returns the images at `index`; may be called from several threads at once while nothing is added.
  [[nodiscard]] RgbdImages load(size_t index) const { return decode_images(encoded(index), options_); }

  /// Returns the compressed images.
  [[nodiscard]] EncodedImages encoded(size_t index) const;

  [[nodiscard]] const ImageStoreOptions& options() const { return options_; }

  [[nodiscard]] size_t size() const { return sizes_.size(); }
  [[nodiscard]] size_t bytes_in_memory() const { return bytes_.bytes_in_memory(); }
  [[nodiscard]] size_t bytes_on_disk() const { return bytes_.bytes_on_disk(); }

 private:
  struct Size {
    int rows = 0, cols = 0;
    size_t color_bytes = 0;
  };

  ImageStoreOptions options_;
  std::vector<Size> sizes_;
  ByteStore bytes_;  // alternating colour and depth
};

}  // namespace kinloop
