#pragma once
// In: filtered rows of a 16-bit grey PNG image, as depth is. Out: their bytes.

#include <array>
#include <cstddef>
#include <cstdint>

namespace kinloop {

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
