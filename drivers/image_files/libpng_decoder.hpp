#pragma once
// In: the bytes of a PNG file of a rare kind: interlaced, with a palette, of another bit depth. Out: its
// pixels.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Decodes any PNG file to 8 or 16 bits and one channel (grey) or three (BGR) with libpng; transparency is
/// left out. Empty if the file is damaged.
cv::Mat decode_png_with_libpng(std::string_view bytes);

}  // namespace kinloop
