#pragma once
// In: the bytes of a binary PGM file (Netpbm), as ScanNet and 3RScan export depth. Out: its pixels.

#include <cstddef>
#include <optional>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

struct PgmHeader {
  int width = 0, height = 0, max_value = 0;
  size_t pixels_begin = 0;  ///< byte
};

/// Returns nullopt unless the bytes begin with the header of a binary PGM.
std::optional<PgmHeader> parse_pgm_header(std::string_view bytes);

/// Decodes 16-bit pixels, which are big-endian by the format, to 16UC1; of 8 bits to 8UC1. Empty if the file
/// is truncated or not a PGM.
cv::Mat decode_pgm(std::string_view bytes);

}  // namespace kinloop
