#pragma once
// In: a source and a mask of what to ignore in each of its images, such as the robot that carries the camera.
// Out: its frames with that mask.

#include <filesystem>
#include <memory>

#include "kinloop/sensor/source/forwarding_source.hpp"

namespace kinloop {

/// Reads a mask for images of this size: an 8-bit PNG or JPEG, black (0) where pixels are to be ignored.
/// Throws InputError naming the file and the remedy.
cv::Mat read_mask(const std::filesystem::path& path, const cv::Size& size);

class MaskedSource : public ForwardingSource {
 public:
  /// `mask` is 8UC1 of the size of the source's camera.
  MaskedSource(std::unique_ptr<FrameSource> source, cv::Mat mask);

  std::optional<Frame> next() override;

 private:
  cv::Mat mask_;
};

}  // namespace kinloop
