#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <type_traits>
#include <vector>

#include "drivers/image_files/png.hpp"

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace kinloop {
namespace {

static_assert(std::endian::native == std::endian::little, "the first byte of a pixel is its lowest");

/// Whichever of left, up and corner (up and left) is nearest to left + up - corner.
int paeth(int left, int up, int corner) {
  const int to_left = std::abs(up - corner), to_up = std::abs(left - corner);
  const int to_corner = std::abs(left + up - 2 * corner);
  const int nearer = to_up <= to_corner ? up : corner;
  return to_left <= std::min(to_up, to_corner) ? left : nearer;
}

/// Byte by byte. Faster than a vector for the two bytes of depth, whose branches are mostly predictable.
template <size_t kPixelBytes>
struct ScalarPaeth {
  std::array<int, kPixelBytes> left{}, corner{};

  uint32_t operator()(uint32_t filtered, uint32_t up_pixel) {
    uint32_t pixel = 0;
    for (size_t i = 0; i < kPixelBytes; ++i) {
      const auto byte = [shift = 8 * i](uint32_t of) { return static_cast<int>(of >> shift & 0xFF); };
      const int up = byte(up_pixel);
      left[i] = (byte(filtered) + paeth(left[i], up, corner[i])) & 0xFF;
      corner[i] = up;
      pixel |= static_cast<uint32_t>(left[i]) << (8 * i);
    }
    return pixel;
  }
};

// A pixel depends on the one to its left, so vectors cannot span pixels: each holds the bytes of one, and
// wider ones than SSE2's, which every x86-64 processor has, would not help.

#ifdef __SSE2__

__m128i vector_of(uint32_t pixel) {
  return _mm_cvtsi32_si128(static_cast<int>(pixel));
}

uint32_t pixel_of(__m128i vector) {
  return static_cast<uint32_t>(_mm_cvtsi128_si32(vector));
}

struct Sub {
  __m128i left = _mm_setzero_si128();

  uint32_t operator()(uint32_t filtered, uint32_t /*up*/) {
    return pixel_of(left = _mm_add_epi8(vector_of(filtered), left));
  }
};

struct Average {
  __m128i left = _mm_setzero_si128();

  uint32_t operator()(uint32_t filtered, uint32_t up_pixel) {
    const __m128i up = vector_of(up_pixel), odd = _mm_and_si128(_mm_xor_si128(left, up), _mm_set1_epi8(1));
    const __m128i mean = _mm_sub_epi8(_mm_avg_epu8(left, up), odd);  // rounded down
    return pixel_of(left = _mm_add_epi8(vector_of(filtered), mean));
  }
};

__m128i words_of(uint32_t pixel) {
  return _mm_unpacklo_epi8(vector_of(pixel), _mm_setzero_si128());
}

__m128i absolute(__m128i words) {
  return _mm_max_epi16(words, _mm_sub_epi16(_mm_setzero_si128(), words));
}

__m128i if_then_else(__m128i mask, __m128i yes, __m128i no) {
  return _mm_or_si128(_mm_and_si128(mask, yes), _mm_andnot_si128(mask, no));
}

/// All bytes at once; the three candidates for a pixel are ready before it is known which is right.
struct VectorPaeth {
  __m128i left = _mm_setzero_si128(), corner = left;

  uint32_t operator()(uint32_t filtered_pixel, uint32_t up_pixel) {
    const __m128i up = words_of(up_pixel), filtered = words_of(filtered_pixel);
    const __m128i up_step = _mm_sub_epi16(up, corner), left_step = _mm_sub_epi16(left, corner);
    const __m128i to_left = absolute(up_step), to_up = absolute(left_step);
    const __m128i to_corner = absolute(_mm_add_epi16(up_step, left_step));
    const __m128i not_left =
        _mm_or_si128(_mm_cmpgt_epi16(to_left, to_up), _mm_cmpgt_epi16(to_left, to_corner));
    const __m128i from_up = _mm_add_epi8(filtered, up), from_corner = _mm_add_epi8(filtered, corner);
    const __m128i nearer = if_then_else(_mm_cmpgt_epi16(to_up, to_corner), from_corner, from_up);
    left = if_then_else(not_left, nearer, _mm_add_epi8(filtered, left));
    corner = up;
    return pixel_of(_mm_packus_epi16(left, left));
  }
};

template <size_t kPixelBytes>
using Paeth = std::conditional_t<kPixelBytes <= 2, ScalarPaeth<kPixelBytes>, VectorPaeth>;

#else

/// Adds the bytes of two pixels: seven bits with carries, the highest without.
uint32_t add_bytes(uint32_t a, uint32_t b) {
  constexpr uint32_t kHighest = 0x80808080;
  return ((a & ~kHighest) + (b & ~kHighest)) ^ ((a ^ b) & kHighest);
}

struct Sub {
  uint32_t left = 0;

  uint32_t operator()(uint32_t filtered, uint32_t /*up*/) { return left = add_bytes(filtered, left); }
};

struct Average {
  uint32_t left = 0;

  uint32_t operator()(uint32_t filtered, uint32_t up) {
    const uint32_t mean = (left & up) + (((left ^ up) & 0xFEFEFEFE) >> 1);
    return left = add_bytes(filtered, mean);
  }
};

template <size_t kPixelBytes>
using Paeth = ScalarPaeth<kPixelBytes>;

#endif

uint32_t pixel_at(const uint8_t* bytes) {
  uint32_t pixel = 0;
  std::memcpy(&pixel, bytes, sizeof pixel);
  return pixel;
}

/// Of three bytes, four are written, since that is one instruction: the next pixel has been read by then. Of
/// the last pixel only its own bytes are.
template <class Filter, size_t kPixelBytes>
void unfilter_pixels(uint8_t* row, const uint8_t* above, size_t size) {
  constexpr size_t kWritten = kPixelBytes == 3 ? 4 : kPixelBytes;
  if (size < kPixelBytes) return;
  Filter filter;
  uint32_t filtered = pixel_at(row);
  size_t at = 0;
  for (; at + kPixelBytes < size; at += kPixelBytes) {
    const uint32_t next = pixel_at(row + at + kPixelBytes);
    const uint32_t pixel = filter(filtered, pixel_at(above + at));
    std::memcpy(row + at, &pixel, kWritten);
    filtered = next;
  }
  const uint32_t last = filter(filtered, pixel_at(above + at));
  std::memcpy(row + at, &last, kPixelBytes);
}

template <size_t kPixelBytes>
void unfilter_row(int filter, uint8_t* row, const uint8_t* above, size_t size) {
  if (filter == 1) unfilter_pixels<Sub, kPixelBytes>(row, above, size);
  if (filter == 3) unfilter_pixels<Average, kPixelBytes>(row, above, size);
  if (filter == 4) unfilter_pixels<Paeth<kPixelBytes>, kPixelBytes>(row, above, size);
}

void unfilter_up(uint8_t* row, const uint8_t* above, size_t size) {
  for (size_t i = 0; i < size; ++i) row[i] = static_cast<uint8_t>(row[i] + above[i]);
}

void unfilter_row(int filter, size_t pixel_bytes, uint8_t* row, const uint8_t* above, size_t size) {
  constexpr int kUp = 2;
  if (filter == kUp) {
    unfilter_up(row, above, size);
  } else if (pixel_bytes == 1) {
    unfilter_row<1>(filter, row, above, size);
  } else if (pixel_bytes == 2) {
    unfilter_row<2>(filter, row, above, size);
  } else if (pixel_bytes == 3) {
    unfilter_row<3>(filter, row, above, size);
  } else {
    unfilter_row<4>(filter, row, above, size);
  }
}

/// The rows from `row` on.
PngRowGroup group_at(uint8_t* row, size_t stride) {
  PngRowGroup group;
  for (size_t k = 0; k < kPngGroupRows; ++k) {
    group.rows[k] = row + k * stride;
    group.filters[k] = group.rows[k][-1];
  }
  return group;
}

/// Paeth's filter alone takes longer for one row than all filters for a group.
bool is_faster_together(const PngRowGroup& group) {
  constexpr int kPaeth = 4;
  return std::find(group.filters.begin(), group.filters.end(), kPaeth) != group.filters.end();
}

}  // namespace

bool unfilter_png(uint8_t* rows, size_t count, size_t pixel_bytes, size_t row_bytes) {
  constexpr int kLast = 4;
  const size_t stride = 1 + row_bytes;
  for (size_t y = 0; y < count; ++y) {
    if (rows[y * stride] > kLast) return false;
  }
  const std::vector<uint8_t> zeros(row_bytes + kPngRowPadding, 0);
  const uint8_t* above = zeros.data();
  for (size_t y = 0; y < count;) {
    uint8_t* row = rows + y * stride + 1;  // behind the number of the filter
    const bool fits = kUnfiltersPngRowGroups && pixel_bytes == 2 && count - y >= kPngGroupRows;
    const PngRowGroup group = fits ? group_at(row, stride) : PngRowGroup{};
    if (is_faster_together(group)) {
      unfilter_png_row_group(group, above, row_bytes / pixel_bytes);
      above = group.rows.back();
      y += kPngGroupRows;
    } else {
      unfilter_row(row[-1], pixel_bytes, row, above, row_bytes);
      above = row;
      ++y;
    }
  }
  return true;
}

}  // namespace kinloop
