#pragma once
// In: OpenEXR files, of any compression, in scan lines or tiles, of one or several parts. Out: depth.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

bool is_exr(std::string_view bytes);

/// Returns the size of the data window of the image that decode_exr decodes. Throws as decode_exr does.
cv::Size exr_size(std::string_view bytes);

/// Decodes the channel of depth (Z, else one named after depth, else R, Y or V, else the first) of half,
/// float or uint32 to 32FC1. Throws InputError for other content, deep pixels and damaged files.
cv::Mat decode_exr(std::string_view bytes);

}  // namespace kinloop
