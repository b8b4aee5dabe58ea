#pragma once
// The bytes of encoded images, and their size in pixels without decoding them.

#include <optional>
#include <string>
#include <string_view>

#include <opencv2/core/types.hpp>

#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

/// Throws InputError if the file or the part of it cannot be read.
std::string read_bytes(const ImageLocation& image);

/// Returns the size in the header of a PNG, JPEG, PGM or depth file of numbers; nullopt for any other
/// content.
std::optional<cv::Size> size_in_header(std::string_view bytes);

/// Returns the size of the first colour or depth image that has one. Throws InputError if none of the first
/// images has; `image` is `&RecordedFrame::color` or `&RecordedFrame::depth`.
cv::Size image_size(const std::vector<RecordedFrame>& frames, ImageLocation RecordedFrame::*image);

}  // namespace kinloop
