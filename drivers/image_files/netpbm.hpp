#pragma once
// In: the bytes of a binary PGM or PPM file (Netpbm), as NYU Depth, ScanNet and 3RScan have them. Out: its
// pixels.

#include <cstddef>
#include <optional>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

struct NetpbmHeader {
  int width = 0, height = 0, max_value = 0;
  int channels = 1;         ///< 3 of a PPM
  size_t pixels_begin = 0;  ///< byte
};

/// Returns whether the bytes begin like a binary PGM or PPM.
bool is_netpbm(std::string_view bytes);

/// Returns nullopt unless the bytes begin with the header of a binary PGM or PPM.
std::optional<NetpbmHeader> parse_netpbm_header(std::string_view bytes);

/// Decodes a PGM to 8UC1 or 16UC1, as the values are; a PPM to 8UC3 or 16UC3 BGR, whose largest value becomes
/// 255 or 65535. Empty if the file is truncated or neither.
cv::Mat decode_netpbm(std::string_view bytes);

}  // namespace kinloop
