#pragma once
// Small videos.

#include <filesystem>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace kinloop::test {

/// Writes 8UC3 images without loss, at 30 Hz.
void write_lossless_video(const std::filesystem::path& file, const std::vector<cv::Mat>& images);

/// Writes a video by MPEG-4 with B-frames, which are stored in another order than shown, at varying
/// intervals.
void write_video_with_b_frames(const std::filesystem::path& file, const std::vector<cv::Mat>& images);

}  // namespace kinloop::test
