#pragma once
// In: a filtered row of a PNG file. Out: its bytes (PNG specification, section 9.2).

#include <cstddef>
#include <cstdint>

namespace kinloop {

/// Bytes behind each row, and behind the row above, that `unfilter_png_row` may read.
inline constexpr size_t kPngRowPadding = 4;

/// Undoes the filter with number `filter` (0 to 4) in `row` of `size` bytes, given the unfiltered row above
/// (of zeros for the first row). `pixel_bytes` is 1 to 4 and divides `size`. Returns false for an unknown
/// filter.
bool unfilter_png_row(int filter, size_t pixel_bytes, uint8_t* row, const uint8_t* above, size_t size);

}  // namespace kinloop
