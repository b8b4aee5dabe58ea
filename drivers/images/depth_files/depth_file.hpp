#pragma once
// In: the bytes of a depth image in a format of numbers: EXR, TIFF, NumPy or OpenCV's YAML. Out: its pixels.
// To add a format, write its file and list it in depth_file.cpp.

#include <optional>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Returns whether the bytes begin like one of these formats.
bool is_depth_file(std::string_view bytes);

/// Returns the size of the image; nullopt for other content. Throws InputError if the header is damaged.
std::optional<cv::Size> depth_file_size(std::string_view bytes);

/// Decodes 16-bit integers to 16UC1 and all other numbers to 32FC1, in the unit of the file. Throws
/// InputError, without the name of the file, if it is damaged or of a kind that kinloop does not read.
cv::Mat decode_depth_file(std::string_view bytes);

/// Returns IEEE 754 binary16 numbers as 32FC1; `data` holds as many as `size` has pixels.
cv::Mat floats_of_halves(std::string_view data, cv::Size size);

/// Throws InputError unless an image can have this size.
cv::Size checked_depth_size(uint64_t width, uint64_t height);

}  // namespace kinloop
