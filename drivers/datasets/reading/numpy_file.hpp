#pragma once
// In: the bytes of a .npy file (NumPy enhancement proposal 1). Out: an image of float32.

#include <filesystem>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Decodes a two-dimensional array of little-endian float32 in C order to 32FC1. Throws InputError naming the
/// file for anything else.
cv::Mat decode_numpy_image(std::string_view bytes, const std::filesystem::path& file);

}  // namespace kinloop
