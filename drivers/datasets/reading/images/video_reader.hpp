#pragma once
// In: a video file. Out: its frames by number.

#include <filesystem>
#include <memory>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Returns whether this build can read videos.
bool video_available();

/// Decodes with libavformat and libavcodec, in the order of presentation.
class VideoReader {
 public:
  /// Throws InputError naming the file if it is not a video, or if this build cannot decode any.
  explicit VideoReader(const std::filesystem::path& file);
  ~VideoReader();
  VideoReader(const VideoReader&) = delete;
  VideoReader& operator=(const VideoReader&) = delete;

  /// Size of the images.
  [[nodiscard]] cv::Size size() const;

  /// Returns frame `index` (from 0) as 8UC3 BGR. Frames are best read in order: an earlier one starts again
  /// from the beginning. Throws InputError at the end of the video and where it is damaged.
  cv::Mat read(size_t index);

 private:
  class Decoder;
  std::filesystem::path file_;
  std::unique_ptr<Decoder> decoder_;
};

}  // namespace kinloop
