#pragma once
// In: the mask of one colour image, as a PNG. Out: a mask for Frame::mask.

#include <string>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/errors.hpp"

namespace kinloop {

/// An intact mask of the wrong kind or size; the rest of its sequence probably has the same problem.
class MaskFormatError : public InputError {
 public:
  using InputError::InputError;
};

/// Decodes an 8-bit grey PNG of `size`: black (0) where pixels are to be ignored, any other value where they
/// are used, which becomes 255. `name` is for messages. Throws MaskFormatError, or InputError if it is
/// damaged.
cv::Mat decode_mask(const std::string& bytes, const cv::Size& size, const std::string& name);

/// Throws MaskFormatError unless the mask has this size.
void require_mask_size(const cv::Size& size, const cv::Size& expected, const std::string& name);

}  // namespace kinloop
