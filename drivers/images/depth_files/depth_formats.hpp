#pragma once
// The formats of depth files, one a source. In: the bytes of a file. Out: its size and pixels.

#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

// In: OpenEXR files, of any compression, in scan lines or tiles, of one or several parts. Out: depth.

bool is_exr(std::string_view bytes);

/// Returns the size of the data window of the image that decode_exr decodes. Throws as decode_exr does.
cv::Size exr_size(std::string_view bytes);

/// Decodes the channel of depth (Z, else one named after depth, else R, Y or V, else the first) of half,
/// float or uint32 to 32FC1. Throws InputError for other content, deep pixels and damaged files.
cv::Mat decode_exr(std::string_view bytes);

// In: TIFF files as depth is written to: one grey image of 16 bits or of floats. Out: its pixels.

/// Returns the size of the image. Throws as decode_tiff does.
cv::Size tiff_size(std::string_view bytes);

/// Decodes an image of uint16 to 16UC1, of int16, uint32, int32, float or double to 32FC1; in strips or
/// tiles, of either byte order, also of BigTIFF; not compressed or by LZW, Deflate, PackBits, Zstandard or
/// LZMA. uint32 of 2^31 and more are negative. Reduced copies of the image are skipped. Throws InputError
/// for anything else: a second page, other pixels, other compressions, damaged files.
cv::Mat decode_tiff(std::string_view bytes);

// In: arrays of NumPy: .npy (NumPy enhancement proposal 1) and .npz, a zip of them. Out: depth images.

bool is_numpy(std::string_view bytes);
cv::Size numpy_size(std::string_view bytes);

/// Decodes a two-dimensional array in C order, or one whose further dimension is 1; of little-endian
/// integers or floats. uint16 gives 16UC1, all else 32FC1. Throws InputError for anything else.
cv::Mat decode_numpy(std::string_view bytes);

bool is_numpy_archive(std::string_view bytes);
cv::Size numpy_archive_size(std::string_view bytes);

/// Decodes the array called depth, else the only one, of a .npz. Throws InputError for anything else.
cv::Mat decode_numpy_archive(std::string_view bytes);

// In: a matrix that OpenCV's FileStorage wrote as YAML (.yml). Out: a depth image. Only the one matrix is
// looked for, without a parser of YAML, which would need a hundred bytes per pixel.

bool is_opencv_yaml(std::string_view bytes);
cv::Size opencv_yaml_size(std::string_view bytes);

/// Decodes the first matrix of one channel: of uint16 (dt: w) to 16UC1, all else to 32FC1. Throws InputError.
cv::Mat decode_opencv_yaml(std::string_view bytes);

}  // namespace kinloop
