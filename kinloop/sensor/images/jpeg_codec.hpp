#pragma once
// In: the bytes of a JPEG file, or pixels. Out: pixels, or the bytes of a JPEG file, by libjpeg-turbo.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Returns the size in the header of a JPEG file; nullopt if it is no JPEG file.
std::optional<cv::Size> jpeg_size(std::string_view bytes);

/// Decodes a JPEG file to 8UC3 BGR. Empty if it is no JPEG file, one that cannot be converted to BGR, or one
/// whose compressed data are damaged, as far as that shows: JPEG has no checksum.
cv::Mat decode_jpeg(std::string_view bytes);

/// Decodes only the luma of a JPEG file, to 8UC1: saves the transforms of the chroma. Empty as above.
cv::Mat decode_jpeg_gray(std::string_view bytes);

/// Encodes an 8UC1 or 8UC3 (BGR) image as JPEG of quality 1 to 100, chroma at half the resolution.
std::vector<uint8_t> encode_jpeg(const cv::Mat& image, int quality);

}  // namespace kinloop
