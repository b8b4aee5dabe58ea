#pragma once
// In: encoded depth images of all layouts. Out: depth in metres.

#include <filesystem>
#include <string>

#include <opencv2/core/mat.hpp>

#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

/// Returns whether an image holds floats, as EXR does. Throws InputError naming the file if it is damaged.
bool has_float_depth(const std::string& bytes, const std::filesystem::path& file);

/// Decodes depth to 32FC1 metres, 0 = unknown; in 16 bits 0 and 65535, in floats all that is not finite and
/// positive, mean unknown. `file` names the image in messages; `size` is that of the depth camera, needed for
/// images without a header; `depth_scale` is the units per metre of those that are not in metres. Throws
/// InputError naming the file and the problem.
cv::Mat decode_depth(const std::string& bytes, const std::filesystem::path& file, DepthEncoding encoding,
                     cv::Size size, double depth_scale);

/// Reads an 8-bit grey image of the size of depth. Throws InputError naming the file and the problem.
cv::Mat read_confidence_image(const std::filesystem::path& file, cv::Size size);

}  // namespace kinloop
