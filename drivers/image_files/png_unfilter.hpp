#pragma once
// In: the filtered rows of a PNG file. Out: their bytes (PNG specification, section 9.2).

#include <cstddef>
#include <cstdint>

namespace kinloop {

/// Bytes behind the last row that `unfilter_png` may read.
inline constexpr size_t kPngRowPadding = 4;

/// Undoes the filters of `count` successive rows of `row_bytes` bytes, each behind the number of its filter
/// (0 to 4). `pixel_bytes` is 1 to 4 and divides `row_bytes`. Returns false if a filter is unknown.
bool unfilter_png(uint8_t* rows, size_t count, size_t pixel_bytes, size_t row_bytes);

}  // namespace kinloop
