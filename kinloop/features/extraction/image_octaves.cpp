#include "kinloop/features/extraction/image_octaves.hpp"

#include <opencv2/imgproc.hpp>

namespace kinloop {

ImageOctaves make_octaves(const cv::Mat& gray, int count) {
  constexpr int kMinSize_px = 32;
  ImageOctaves octaves{gray};
  while (static_cast<int>(octaves.size()) < count) {
    const cv::Mat& finer = octaves.back();
    const cv::Size half(finer.cols / 2, finer.rows / 2);
    if (half.width < kMinSize_px || half.height < kMinSize_px) break;
    cv::Mat coarser;
    cv::resize(finer(cv::Rect(0, 0, 2 * half.width, 2 * half.height)), coarser, half, 0, 0, cv::INTER_AREA);
    octaves.push_back(coarser);
  }
  return octaves;
}

}  // namespace kinloop
