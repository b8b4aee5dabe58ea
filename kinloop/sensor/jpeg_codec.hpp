#pragma once
// In: the bytes of a JPEG file, or pixels. Out: pixels, or the bytes of a JPEG file, by libjpeg-turbo.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Decodes a JPEG file to 8UC3 BGR. Empty if it is no JPEG file, or one that cannot be converted to BGR. As
/// with other readers, errors within the compressed data spoil only the pixels behind them.
cv::Mat decode_jpeg(std::string_view bytes);

/// Decodes only the luma of a JPEG file, to 8UC1: less than half the time of colour. Empty as above.
cv::Mat decode_jpeg_gray(std::string_view bytes);

}  // namespace kinloop
