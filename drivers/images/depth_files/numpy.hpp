#pragma once
// In: arrays of NumPy: .npy (NumPy enhancement proposal 1) and .npz, a zip of them. Out: depth images.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

bool is_numpy(std::string_view bytes);
cv::Size numpy_size(std::string_view bytes);

/// Decodes a two-dimensional array in C order, or one whose further dimension is 1; of little-endian
/// integers or floats. uint16 gives 16UC1, all else 32FC1. Throws InputError for anything else.
cv::Mat decode_numpy(std::string_view bytes);

bool is_numpy_archive(std::string_view bytes);
cv::Size numpy_archive_size(std::string_view bytes);

/// Decodes the array called depth, else the only one, of a .npz. Throws InputError for anything else.
cv::Mat decode_numpy_archive(std::string_view bytes);

}  // namespace kinloop
