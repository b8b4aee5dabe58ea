#pragma once
// In: a JPEG or PNG image, or depth compressed with RVL, inside a recording or stream. Out: its pixels. Sizes
// are checked before memory is allocated.

#include <cstdint>
#include <span>

#include <opencv2/core/mat.hpp>

#include "kinloop/sensor/images/color_image.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {

/// The largest image that is decoded, pixels; a header that claims more is damaged or hostile.
constexpr auto kMaxImagePixels = static_cast<int64_t>(kMaxDecodedPixels);

/// Decodes a whole JPEG or PNG image to its own type. Throws InputError if it is neither, truncated, damaged
/// or larger than kMaxImagePixels.
cv::Mat decode_embedded_image(std::span<const uint8_t> bytes);

/// Same, as a colour image; a JPEG is kept as it is. Throws InputError if it does not have 8 bits per
/// channel.
ColorImage decode_embedded_color(std::span<const uint8_t> bytes);

/// Returns depth in metres (32FC1) with 0 = unknown in place of what is not finite and positive.
cv::Mat without_impossible_depth(cv::Mat depth_m);

/// Decodes 16-bit depth compressed with RVL (Wilson 2017) of `size` pixels to 16UC1. Throws InputError if
/// truncated or of another size.
cv::Mat decode_rvl(std::span<const uint8_t> bytes, cv::Size size);

}  // namespace kinloop
