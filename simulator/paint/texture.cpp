#include "simulator/paint/texture.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"

namespace kinloop::sim {
namespace {

using Bytes = uint8_t __attribute__((vector_size(4)));

Lanes to_lanes(uint32_t pixel) {
  return __builtin_convertvector(std::bit_cast<Bytes>(pixel), Lanes);
}

/// Base-2 logarithm, piecewise linear: accurate enough to choose a pyramid level.
float approximate_log2(float x) {
  const auto bits = static_cast<float>(std::bit_cast<int32_t>(x));
  constexpr float kMantissaSteps = 1 << 23;
  constexpr float kBias = 127;
  return bits / kMantissaSteps - kBias;
}

/// Floor for moderate values; std::floor is a function call without SSE4.
int floor_int(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (static_cast<float>(truncated) > x ? 1 : 0);
}

}  // namespace

Texture::Texture(const cv::Mat& image) {
  require(image.type() == CV_8UC3, "a texture needs an 8-bit BGR image");
  require(std::has_single_bit(static_cast<unsigned>(image.cols)) &&
              std::has_single_bit(static_cast<unsigned>(image.rows)),
          "texture sizes must be powers of two");
  cv::Mat current = image;
  while (true) {
    Level level{current.cols, current.rows, {}};
    level.pixels.reserve(static_cast<size_t>(current.cols) * static_cast<size_t>(current.rows));
    for (int y = 0; y < current.rows; ++y) {
      const auto* row = current.ptr<cv::Vec3b>(y);
      for (int x = 0; x < current.cols; ++x) {
        level.pixels.push_back(static_cast<uint32_t>(row[x][0] | row[x][1] << 8 | row[x][2] << 16));
      }
    }
    levels_.push_back(std::move(level));
    if (current.cols == 1 && current.rows == 1) break;
    cv::Mat halved;
    cv::resize(current, halved, {std::max(1, current.cols / 2), std::max(1, current.rows / 2)}, 0, 0,
               cv::INTER_AREA);
    current = halved;
  }
}

Lanes Texture::bilinear(const Level& level, float u, float v) {
  const float x = u * static_cast<float>(level.width) - 0.5F;
  const float y = v * static_cast<float>(level.height) - 0.5F;
  const int x0 = floor_int(x), y0 = floor_int(y);
  const float ax = x - static_cast<float>(x0), ay = y - static_cast<float>(y0);
  // Sizes are powers of two, so masking wraps.
  const auto left = static_cast<size_t>(x0 & (level.width - 1));
  const auto right = static_cast<size_t>((x0 + 1) & (level.width - 1));
  const uint32_t* upper =
      level.pixels.data() + static_cast<size_t>(y0 & (level.height - 1)) * static_cast<size_t>(level.width);
  const uint32_t* lower = level.pixels.data() + static_cast<size_t>((y0 + 1) & (level.height - 1)) *
                                                    static_cast<size_t>(level.width);
  const Lanes a = to_lanes(upper[left]), b = to_lanes(upper[right]);
  const Lanes c = to_lanes(lower[left]), d = to_lanes(lower[right]);
  const Lanes top = a + ax * (b - a);
  const Lanes bottom = c + ax * (d - c);
  return top + ay * (bottom - top);
}

float Texture::level_of(float footprint_px) const {
  const auto last = static_cast<float>(levels_.size() - 1);
  return std::clamp(approximate_log2(std::max(footprint_px, 1.0F)), 0.0F, last);
}

Lanes Texture::sample_sum(Lanes u, Lanes v, float footprint_px) const {
  const float level = level_of(footprint_px);
  constexpr float kThresholds[kLanes] = {0.125F, 0.625F, 0.875F, 0.375F};
  Lanes sum = all_lanes(0);
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto chosen = static_cast<size_t>(level + kThresholds[lane]);
    sum += bilinear(levels_[std::min(chosen, levels_.size() - 1)], u[lane], v[lane]);
  }
  return sum;
}

Lanes Texture::sample(float u, float v, float footprint_px) const {
  const float level = level_of(footprint_px);
  const int fine = static_cast<int>(level);
  const float weight = level - static_cast<float>(fine);
  const Lanes sharp = bilinear(levels_[static_cast<size_t>(fine)], u, v);
  constexpr float kNegligible = 1.0F / 64;
  if (weight < kNegligible) return sharp;
  const Lanes soft = bilinear(levels_[static_cast<size_t>(fine) + 1], u, v);
  return sharp + weight * (soft - sharp);
}

}  // namespace kinloop::sim
