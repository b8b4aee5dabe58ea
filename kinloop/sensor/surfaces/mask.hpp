#pragma once
// Masks of images: 8UC1, 0 = to be ignored, anything else = used; an empty one uses all.

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Why a pixel of a frame is ignored: the bits of Frame::ignored.
enum class IgnoreCause : uint8_t {
  kUser = 1,           ///< the mask that came with the frame
  kFixedToCamera = 2,  ///< it moves with the camera
  kMoved = 4,          ///< it moved in the previous frame
};

/// Returns the causes (8UC1; empty = none) with `cause` where `mask` is 0.
cv::Mat with_cause(const cv::Mat& causes, const cv::Mat& mask, IgnoreCause cause);

/// Returns the mask of the pixels without any cause; empty if `causes` is.
cv::Mat used_pixels(const cv::Mat& causes);

/// Returns the mask of what both use. Masks that are not empty must have the same size.
cv::Mat intersection_of_masks(const cv::Mat& a, const cv::Mat& b);

}  // namespace kinloop
