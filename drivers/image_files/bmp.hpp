#pragma once
// In: the bytes of a Windows bitmap (BMP). Out: its pixels.

#include <optional>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Returns whether the bytes begin like a bitmap.
bool is_bmp(std::string_view bytes);

/// Returns the size in the header; nullopt if there is none.
std::optional<cv::Size> bmp_size(std::string_view bytes);

/// Decodes 24 or 32 bits per pixel, or 8 with a palette, not compressed, to 8UC3 BGR. Empty if the file is
/// truncated or of another kind.
cv::Mat decode_bmp(std::string_view bytes);

}  // namespace kinloop
