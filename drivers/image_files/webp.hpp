#pragma once
// In: the bytes of a WebP image. Out: its pixels, by libwebp.

#include <optional>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Returns whether this build decodes WebP.
bool webp_available();

/// Returns whether the bytes begin like WebP.
bool is_webp(std::string_view bytes);

/// Returns the size in the header; nullopt if there is none, or if this build does not decode WebP.
std::optional<cv::Size> webp_size(std::string_view bytes);

/// Decodes to 8UC3 BGR, without transparency. Empty if the file is damaged, truncated or animated, or if this
/// build does not decode WebP.
cv::Mat decode_webp(std::string_view bytes);

}  // namespace kinloop
