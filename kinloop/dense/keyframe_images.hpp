#pragma once
// In: colour and depth images of a run, one after the other. Out: the same images again, at the end, when
// their poses are known for good. In between they are kept small: colour as JPEG, depth packed without loss,
// and beyond a limit in a temporary file instead of memory.

#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace kinloop {

struct ImageStoreOptions {
  double depth_scale = 5000;  ///< units per metre in which depth is kept, as those of the camera
  int jpeg_quality = 95;
  size_t memory_limit_bytes = size_t{64} << 20;
};

/// A colour image and its depth.
struct RgbdImages {
  cv::Mat color;    ///< 8UC3, BGR
  cv::Mat depth_m;  ///< 32FC1, 0 = unknown
};

/// The same made small: colour as JPEG, depth as `pack_depth` gives it.
struct EncodedImages {
  int rows = 0, cols = 0;
  std::vector<uint8_t> color;
  std::vector<uint8_t> depth;

  bool operator==(const EncodedImages&) const = default;
};

class KeyframeImages {
 public:
  KeyframeImages() = default;
  explicit KeyframeImages(const ImageStoreOptions& options) : options_(options) {}

  /// Keeps a copy and returns its index, counted from 0. Depth is rounded to the units of `depth_scale`; what
  /// they cannot hold becomes unknown. Throws InputError when the temporary file cannot be written.
  size_t add(const cv::Mat& color, const cv::Mat& depth_m);

  /// Keeps images that another store gave; their depth must be in the units of this one.
  size_t add(const EncodedImages& images);

  /// The images at `index`; may be called from several threads at once while nothing is added.
  [[nodiscard]] RgbdImages load(size_t index) const;

  /// The same as they are kept.
  [[nodiscard]] EncodedImages encoded(size_t index) const;

  [[nodiscard]] const ImageStoreOptions& options() const { return options_; }

  [[nodiscard]] size_t size() const { return entries_.size(); }
  [[nodiscard]] size_t bytes_in_memory() const { return bytes_in_memory_; }
  [[nodiscard]] size_t bytes_on_disk() const { return bytes_on_disk_; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  struct Entry {
    int rows = 0, cols = 0;
    size_t color_bytes = 0, depth_bytes = 0;
    size_t file_offset = 0;      // where `bytes` is empty
    std::vector<uint8_t> bytes;  // colour, then depth
  };

  void spill(const std::vector<uint8_t>& bytes);
  [[nodiscard]] std::vector<uint8_t> bytes_of(const Entry& entry) const;

  ImageStoreOptions options_;
  std::vector<Entry> entries_;
  std::unique_ptr<std::FILE, CloseFile>
      file_;  // has no name: it is gone when the program is, however it ends
  size_t bytes_in_memory_ = 0;
  size_t bytes_on_disk_ = 0;
};

}  // namespace kinloop
