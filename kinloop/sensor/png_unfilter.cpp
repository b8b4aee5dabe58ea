#include "kinloop/sensor/png_unfilter.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace kinloop {
namespace {

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

/// Predicts whichever of left, up and corner (up and left) is nearest to left + up - corner.
struct Paeth {
  __m128i left = _mm_setzero_si128(), corner = left;

  uint32_t operator()(uint32_t filtered, uint32_t up_pixel) {
    const __m128i up = words_of(up_pixel);
    const __m128i up_step = _mm_sub_epi16(up, corner), left_step = _mm_sub_epi16(left, corner);
    const __m128i to_left = absolute(up_step), to_up = absolute(left_step);
    const __m128i to_corner = absolute(_mm_add_epi16(up_step, left_step));
    const __m128i nearest = _mm_min_epi16(to_corner, _mm_min_epi16(to_left, to_up));
    const __m128i no_left = if_then_else(_mm_cmpeq_epi16(nearest, to_up), up, corner);
    const __m128i predicted = if_then_else(_mm_cmpeq_epi16(nearest, to_left), left, no_left);
    left = _mm_and_si128(_mm_add_epi16(words_of(filtered), predicted), _mm_set1_epi16(0xFF));
    corner = up;
    return pixel_of(_mm_packus_epi16(left, left));
  }
};

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

/// Predicts whichever of left, up and corner (up and left) is nearest to left + up - corner.
struct Paeth {
  uint32_t left = 0, corner = 0;

  uint32_t operator()(uint32_t filtered, uint32_t up) {
    uint32_t predicted = 0;
    for (int shift = 0; shift < 32; shift += 8) {
      const auto byte = [shift](uint32_t pixel) { return static_cast<int>(pixel >> shift & 0xFF); };
      const int a = byte(left), b = byte(up), c = byte(corner);
      const int to_left = std::abs(b - c), to_up = std::abs(a - c), to_corner = std::abs(a + b - 2 * c);
      const int no_left = to_up <= to_corner ? b : c;
      const int nearest = to_left <= std::min(to_up, to_corner) ? a : no_left;
      predicted |= static_cast<uint32_t>(nearest) << shift;
    }
    corner = up;
    return left = add_bytes(filtered, predicted);
  }
};

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

template <class Filter>
void unfilter_row(size_t pixel_bytes, uint8_t* row, const uint8_t* above, size_t size) {
  switch (pixel_bytes) {
    case 1:
      return unfilter_pixels<Filter, 1>(row, above, size);
    case 2:
      return unfilter_pixels<Filter, 2>(row, above, size);
    case 3:
      return unfilter_pixels<Filter, 3>(row, above, size);
    default:
      return unfilter_pixels<Filter, 4>(row, above, size);
  }
}

void unfilter_up(uint8_t* row, const uint8_t* above, size_t size) {
  for (size_t i = 0; i < size; ++i) row[i] = static_cast<uint8_t>(row[i] + above[i]);
}

}  // namespace

bool unfilter_png_row(int filter, size_t pixel_bytes, uint8_t* row, const uint8_t* above, size_t size) {
  switch (filter) {
    case 0:
      return true;
    case 1:
      unfilter_row<Sub>(pixel_bytes, row, above, size);
      return true;
    case 2:
      unfilter_up(row, above, size);
      return true;
    case 3:
      unfilter_row<Average>(pixel_bytes, row, above, size);
      return true;
    case 4:
      unfilter_row<Paeth>(pixel_bytes, row, above, size);
      return true;
    default:
      return false;
  }
}

}  // namespace kinloop
