#pragma once
// In: a sequence folder with masks of its colour images, such as a segmentation network makes. Out: the mask
// of each frame.

#include <filesystem>

#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

/// Notes the mask of each frame: masks/STEM.png in `folder`, where STEM is the file name of the colour image
/// without its extension. Frames without a file have no mask. Throws InputError if there are masks, but none
/// of a frame: they would be ignored silently.
void find_masks(const std::filesystem::path& folder, RecordedSequence& sequence);

/// Throws InputError if the first masks cannot be meant: of another size, or black all over, as where the
/// pixels to ignore are white.
void require_usable_masks(const RecordedSequence& sequence, const cv::Size& size);

/// Reads the mask of a frame; empty if it has none. See decode_mask.
cv::Mat read_frame_mask(const RecordedFrame& frame, const cv::Size& size);

}  // namespace kinloop
