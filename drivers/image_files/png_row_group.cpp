#include "drivers/image_files/png.hpp"

#ifdef __SSE2__

#include <algorithm>
#include <cstring>

#include <emmintrin.h>

namespace kinloop {
namespace {

__m128i group_absolute(__m128i words) {
  return _mm_max_epi16(words, _mm_sub_epi16(_mm_setzero_si128(), words));
}

__m128i group_select(__m128i mask, __m128i yes, __m128i no) {
  return _mm_or_si128(_mm_and_si128(mask, yes), _mm_andnot_si128(mask, no));
}

/// A 16-bit word for each byte of the pixels, of which the first row's is in the lowest bits.
__m128i unpacked(uint64_t pixels) {
  return _mm_unpacklo_epi8(_mm_cvtsi64_si128(static_cast<long long>(pixels)), _mm_setzero_si128());
}

uint64_t packed(__m128i words) {
  return static_cast<uint64_t>(_mm_cvtsi128_si64(_mm_packus_epi16(words, words)));
}

/// All bits of the rows with this filter.
__m128i rows_with(int filter, const PngRowGroup& group) {
  std::array<int32_t, kPngGroupRows> mask{};
  for (size_t k = 0; k < kPngGroupRows; ++k) mask[k] = group.filters[k] == filter ? -1 : 0;
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(mask.data()));
}

/// One pixel of each row.
class GroupStep {
 public:
  explicit GroupStep(const PngRowGroup& group)
      : sub_(rows_with(1, group)),
        up_(rows_with(2, group)),
        average_(rows_with(3, group)),
        paeth_(rows_with(4, group)) {}

  /// Returns the next pixel of each row. `above` is the pixel above that of the first.
  uint64_t operator()(uint64_t filtered, uint64_t above) {
    constexpr int kPixelBytes = 4;  // of a pixel's words
    const __m128i corner = above_;
    above_ = _mm_or_si128(_mm_slli_si128(left_, kPixelBytes), unpacked(above));
    const __m128i mean = _mm_srli_epi16(_mm_add_epi16(left_, above_), 1);
    const __m128i neighbor = _mm_or_si128(_mm_and_si128(sub_, left_), _mm_and_si128(up_, above_));
    const __m128i computed =
        _mm_or_si128(_mm_and_si128(average_, mean), _mm_and_si128(paeth_, paeth(corner)));
    const __m128i sum = _mm_add_epi16(unpacked(filtered), _mm_or_si128(neighbor, computed));
    left_ = _mm_and_si128(sum, _mm_set1_epi16(0xFF));
    return packed(left_);
  }

 private:
  /// Whichever of left, above and corner is nearest to left + above - corner.
  [[nodiscard]] __m128i paeth(__m128i corner) const {
    const __m128i above_step = _mm_sub_epi16(above_, corner), left_step = _mm_sub_epi16(left_, corner);
    const __m128i to_left = group_absolute(above_step), to_above = group_absolute(left_step);
    const __m128i to_corner = group_absolute(_mm_add_epi16(above_step, left_step));
    const __m128i nearer = group_select(_mm_cmpgt_epi16(to_above, to_corner), corner, above_);
    const __m128i not_left = _mm_cmpgt_epi16(to_left, _mm_min_epi16(to_above, to_corner));
    return group_select(not_left, nearer, left_);
  }

  __m128i sub_, up_, average_, paeth_;
  __m128i left_ = _mm_setzero_si128(), above_ = left_;
};

uint64_t group_pixel(const uint8_t* row, size_t x) {
  uint16_t pixel = 0;
  std::memcpy(&pixel, row + 2 * x, sizeof pixel);
  return pixel;
}

}  // namespace

void unfilter_png_row_group(const PngRowGroup& group, const uint8_t* above, size_t cols) {
  constexpr size_t kBehind = kPngGroupRows - 1, kBits = 16;  // of a pixel
  GroupStep next(group);
  const auto advance = [&](size_t step, auto has_pixel) {
    uint64_t filtered = 0;
    for (size_t k = 0; k < kPngGroupRows; ++k) {
      if (has_pixel(k)) filtered |= group_pixel(group.rows[k], step - k) << (kBits * k);
    }
    const uint64_t pixels = next(filtered, has_pixel(0) ? group_pixel(above, step) : 0);
    for (size_t k = 0; k < kPngGroupRows; ++k) {
      const auto pixel = static_cast<uint16_t>(pixels >> (kBits * k));
      if (has_pixel(k)) std::memcpy(group.rows[k] + 2 * (step - k), &pixel, sizeof pixel);
    }
  };
  // A row that has not begun reads zeros, which give zeros.
  for (size_t step = 0; step < cols + kBehind; ++step) {
    if (step >= kBehind && step < cols) {
      advance(step, [](size_t /*row*/) { return true; });
    } else {
      advance(step, [&](size_t k) { return step >= k && step - k < cols; });
    }
  }
}

}  // namespace kinloop

#else

namespace kinloop {

void unfilter_png_row_group(const PngRowGroup& /*group*/, const uint8_t* /*above*/, size_t /*cols*/) {}

}  // namespace kinloop

#endif
