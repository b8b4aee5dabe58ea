#pragma once
// In: TIFF files as depth is written to: one grey image of 16 bits or of floats. Out: its pixels.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Returns the size of the image. Throws as decode_tiff does.
cv::Size tiff_size(std::string_view bytes);

/// Decodes an image of uint16 to 16UC1, of int16, uint32, int32, float or double to 32FC1; in strips or
/// tiles, of either byte order, also of BigTIFF; not compressed or by LZW, Deflate, PackBits, Zstandard or
/// LZMA. uint32 of 2^31 and more are negative. Reduced copies of the image are skipped. Throws InputError
/// for anything else: a second page, other pixels, other compressions, damaged files.
cv::Mat decode_tiff(std::string_view bytes);

}  // namespace kinloop
