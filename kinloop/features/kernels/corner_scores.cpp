#include "kinloop/features/kernels/corner_scores.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

#include "kinloop/core/errors.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kinloop/features/kernels/corner_scores.cpp"
#include <hwy/foreach_target.h>  // compiles this file once for each instruction set
#include <hwy/highway.h>         // after foreach_target.h

#include "kinloop/core/highway_compat-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace kinloop::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = CappedLanes<uint8_t, kMinCornerWidth>;
using ByteVector = hn::Vec<Bytes>;

/// The best, over all arcs of 9 of the 16 circle values, of the worst value within the arc; `Worst` and
/// `Best` are minimum and maximum or vice versa.
template <class Worst, class Best>
HWY_INLINE ByteVector best_arc(const ByteVector* circle, Worst worst, Best best) {
  // Runs of 2, 4 and 8 pixels that begin at odd positions. The arcs that begin just before and at such a
  // position share its run of 8 and differ in one pixel at either end.
  ByteVector two[8], four[8];
  for (size_t i = 0; i < 8; ++i) two[i] = worst(circle[2 * i + 1], circle[(2 * i + 2) % 16]);
  for (size_t i = 0; i < 8; ++i) four[i] = worst(two[i], two[(i + 1) % 8]);
  const auto arcs = [&](size_t i) {
    const ByteVector eight = worst(four[i], four[(i + 2) % 8]);
    return worst(eight, best(circle[2 * i], circle[(2 * i + 9) % 16]));
  };
  ByteVector result = arcs(0);
  for (size_t i = 1; i < 8; ++i) result = best(result, arcs(i));
  return result;
}

/// Scores `width` pixels from `centre` on: contrast minus `threshold`, clamped at 0.
void score_row(const uint8_t* centre, const ptrdiff_t* circle, int width, int threshold, uint8_t* scores) {
  const Bytes d;
  const int last = width - static_cast<int>(hn::Lanes(d));  // the last vector overlaps the previous one
  const auto lower = [](auto a, auto b) HWY_ATTR { return hn::Min(a, b); };
  const auto higher = [](auto a, auto b) HWY_ATTR { return hn::Max(a, b); };
  const auto limit = hn::Set(d, static_cast<uint8_t>(threshold));
  for (int begin = 0; begin < width; begin += static_cast<int>(hn::Lanes(d))) {
    const int x = std::min(begin, last);
    const auto here = hn::LoadU(d, centre + x);
    ByteVector pixels[16];
    for (size_t i = 0; i < 16; ++i) pixels[i] = hn::LoadU(d, centre + x + circle[i]);
    const auto brighter = hn::SaturatedSub(best_arc(pixels, lower, higher), here);
    const auto darker = hn::SaturatedSub(here, best_arc(pixels, higher, lower));
    hn::StoreU(hn::SaturatedSub(hn::Max(brighter, darker), limit), d, scores + x);
  }
}

/// Keeps the scores of `here` that are maxima among their eight neighbours and zeroes the others.
void maxima_of_row(const uint8_t* above, const uint8_t* here, const uint8_t* below, int width,
                   uint8_t* maxima) {
  const Bytes d;
  const int last = width - static_cast<int>(hn::Lanes(d));
  const auto highest = [d](const uint8_t* a, const uint8_t* b, const uint8_t* c, const uint8_t* e) HWY_ATTR {
    return hn::Max(hn::Max(hn::LoadU(d, a), hn::LoadU(d, b)), hn::Max(hn::LoadU(d, c), hn::LoadU(d, e)));
  };
  for (int begin = 0; begin < width; begin += static_cast<int>(hn::Lanes(d))) {
    const int x = std::min(begin, last);
    const auto score = hn::LoadU(d, here + x);
    const auto before = highest(above + x - 1, above + x, above + x + 1, here + x - 1);
    const auto after = highest(below + x - 1, below + x, below + x + 1, here + x + 1);
    const auto beats_after = hn::IfThenElseZero(hn::Eq(hn::Max(score, after), score), score);
    hn::StoreU(hn::IfThenZeroElse(hn::Eq(hn::Max(score, before), before), beats_after), d, maxima + x);
  }
}

}  // namespace
}  // namespace kinloop::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kinloop {
namespace {

HWY_EXPORT(score_row);
HWY_EXPORT(maxima_of_row);

constexpr int kRadius = 3;

/// Memory offsets from a pixel to the 16 pixels of its circle, in circular order.
std::array<ptrdiff_t, 16> circle_steps(ptrdiff_t stride) {
  constexpr std::array<std::array<int, 2>, 16> kCircle{{{0, 3},
                                                        {1, 3},
                                                        {2, 2},
                                                        {3, 1},
                                                        {3, 0},
                                                        {3, -1},
                                                        {2, -2},
                                                        {1, -3},
                                                        {0, -3},
                                                        {-1, -3},
                                                        {-2, -2},
                                                        {-3, -1},
                                                        {-3, 0},
                                                        {-3, 1},
                                                        {-2, 2},
                                                        {-1, 3}}};
  std::array<ptrdiff_t, 16> steps;
  for (size_t i = 0; i < steps.size(); ++i) steps[i] = kCircle[i][1] * stride + kCircle[i][0];
  return steps;
}

/// Offset of the peak of the parabola through three neighbouring scores, relative to the middle one.
float peak_offset(int before, int middle, int after) {
  const int bend = 2 * middle - before - after;
  return bend > 0 ? 0.5F * static_cast<float>(after - before) / static_cast<float>(bend) : 0;
}

/// Scores of three rows, padded by one element on either side; zero where there is no corner.
struct ScoreRows {
  const uint8_t* above;
  const uint8_t* here;
  const uint8_t* below;
};

/// Appends the nonzero positions of `maxima`, which begin at `start`, as corners.
void append_corners(const ScoreRows& scores, std::span<const uint8_t> maxima, const cv::Point& start,
                    int threshold, std::vector<RawCorner>& corners) {
  const auto width = static_cast<int>(maxima.size());
  for (int x = 0; x < width; ++x) {
    uint64_t eight = 1;
    if (x + 8 <= width) std::memcpy(&eight, maxima.data() + x, sizeof eight);
    if (eight == 0) {  // true for most
      x += 7;
      continue;
    }
    const int score = maxima[static_cast<size_t>(x)];
    if (score == 0) continue;
    corners.push_back({start.x + x, start.y, score + threshold,
                       peak_offset(scores.here[x - 1], score, scores.here[x + 1]),
                       peak_offset(scores.above[x], score, scores.below[x])});
  }
}

}  // namespace

std::vector<RawCorner> find_corners(const cv::Mat& image, int threshold, int border) {
  require(image.type() == CV_8UC1, "find_corners: the image must be 8-bit grey");
  require(border >= kRadius && threshold >= 0 && threshold < 256,
          "find_corners: invalid border or threshold");
  const int width = image.cols - 2 * border, height = image.rows - 2 * border;
  if (width < kMinCornerWidth || height <= 0) return {};
  std::array<std::vector<uint8_t>, 3> scores;  // three rows, padded by one element on either side
  scores.fill(std::vector<uint8_t>(static_cast<size_t>(width) + 2));
  std::vector<uint8_t> maxima(static_cast<size_t>(width));
  const auto circle = circle_steps(static_cast<ptrdiff_t>(image.step));
  std::vector<RawCorner> corners;
  for (int row = 0; row <= height; ++row) {  // scores run one row ahead of the maxima
    auto& ahead = scores[static_cast<size_t>((row + 1) % 3)];
    if (row < height) {
      HWY_DYNAMIC_DISPATCH(score_row)
      (image.ptr<uint8_t>(border + row) + border, circle.data(), width, threshold, ahead.data() + 1);
    } else {
      std::fill(ahead.begin(), ahead.end(), uint8_t{0});
    }
    if (row == 0) continue;
    const ScoreRows rows{scores[static_cast<size_t>((row + 2) % 3)].data() + 1,
                         scores[static_cast<size_t>(row % 3)].data() + 1, ahead.data() + 1};
    HWY_DYNAMIC_DISPATCH(maxima_of_row)(rows.above, rows.here, rows.below, width, maxima.data());
    append_corners(rows, maxima, {border, border + row - 1}, threshold, corners);
  }
  return corners;
}

}  // namespace kinloop
#endif
