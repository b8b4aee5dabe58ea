#pragma once
// In: depth compressed by OpenNI, in a recording. Out: its pixels.

#include <opencv2/core/mat.hpp>

#include "kinloop/core/files/byte_reader.hpp"

namespace kinloop {

/// Decodes depth of codec 16z to 16UC1. `with_table`: the values are indices into a table in front of them
/// (16zT), otherwise depth itself (16zP). Throws InputError if truncated or of another size.
cv::Mat decode_16z(Bytes bytes, cv::Size size, bool with_table);

}  // namespace kinloop
