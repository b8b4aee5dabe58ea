#pragma once
// In: TIFF files as depth is written to: one grey image of 16 bits or of floats. Out: its pixels.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Returns the size of the first image. Throws InputError if the header is damaged.
cv::Size tiff_size(std::string_view bytes);

/// Decodes the first image: of uint16 to 16UC1, of int16, uint32, int32, float or double to 32FC1; in strips
/// or tiles, not compressed or by LZW, Deflate or PackBits, with any predictor; of either byte order. Throws
/// InputError for anything else.
cv::Mat decode_tiff(std::string_view bytes);

}  // namespace kinloop
