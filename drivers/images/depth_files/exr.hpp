#pragma once
// In: OpenEXR files as depth is written to: one part of scan lines. Out: its pixels. Own code, since Debian's
// library would be needed for this alone, and must not be trusted with crafted files.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

bool is_exr(std::string_view bytes);

/// Returns the size of the data window. Throws InputError if the header is damaged.
cv::Size exr_size(std::string_view bytes);

/// Decodes the channel of depth (Z, else one named after depth, else R, Y or the first) of half, float or
/// uint32 to 32FC1; not compressed, or by RLE, ZIPS or ZIP. Throws InputError for anything else.
cv::Mat decode_exr(std::string_view bytes);

}  // namespace kinloop
