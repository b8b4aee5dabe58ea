#pragma once
// In: the bytes of a PNG file. Out: its pixels.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Decodes a PNG file of any kind to 8 or 16 bits and one channel (grey) or three (BGR); transparency is left
/// out. Empty if the file is damaged.
cv::Mat decode_png(std::string_view bytes);

/// Decodes the kinds that recordings use in half of libpng's time, by libdeflate: non-interlaced 8-bit grey,
/// RGB and RGBA, and 16-bit grey. Empty if the file is damaged or of another kind.
cv::Mat decode_common_png(std::string_view bytes);

}  // namespace kinloop
