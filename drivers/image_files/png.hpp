#pragma once
// The parts of reading a PNG file: its bytes are inflated, its rows unfiltered.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Decodes a PNG file of any kind to 8 or 16 bits and one channel (grey) or three (BGR); transparency is left
/// out. Empty if the file is damaged.
cv::Mat decode_png(std::string_view bytes);

/// Decodes the kinds that recordings use in half of libpng's time, by libdeflate: non-interlaced 8-bit grey,
/// RGB and RGBA, and 16-bit grey. Empty if the file is damaged or of another kind.
cv::Mat decode_common_png(std::string_view bytes);

/// Decodes any PNG file to 8 or 16 bits and one channel (grey) or three (BGR) with libpng; transparency is
/// left out. Empty if the file is damaged.
cv::Mat decode_png_with_libpng(std::string_view bytes);

/// Bytes behind the last row that `unfilter_png` may read.
inline constexpr size_t kPngRowPadding = 4;

/// Undoes the filters of `count` successive rows of `row_bytes` bytes, each behind the number of its filter
/// (0 to 4). `pixel_bytes` is 1 to 4 and divides `row_bytes`. Returns false if a filter is unknown.
bool unfilter_png(uint8_t* rows, size_t count, size_t pixel_bytes, size_t row_bytes);

/// Rows that are unfiltered together. Within a row each pixel depends on the one to its left. So each row is
/// kept one pixel behind the row above, and the pixels that they have reached do not depend on each other.
inline constexpr size_t kPngGroupRows = 4;

struct PngRowGroup {
  std::array<int, kPngGroupRows> filters{};  ///< 0 to 4
  std::array<uint8_t*, kPngGroupRows> rows{};
};

/// Whether the processor has vectors for it.
#ifdef __SSE2__
inline constexpr bool kUnfiltersPngRowGroups = true;
#else
inline constexpr bool kUnfiltersPngRowGroups = false;
#endif

/// Undoes the filters of successive rows of `cols` pixels of two bytes, given the unfiltered row above.
void unfilter_png_row_group(const PngRowGroup& group, const uint8_t* above, size_t cols);

}  // namespace kinloop
