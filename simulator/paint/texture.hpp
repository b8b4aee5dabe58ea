#pragma once
// In: images. Out: colours filtered over the footprint of a pixel, to avoid aliasing.

#include <vector>

#include <opencv2/core/mat.hpp>

#include "simulator/render/lanes.hpp"

namespace kinloop::sim {

/// A periodic texture with its mipmap pyramid (Williams 1983, "Pyramidal parametrics"). Width and height are
/// powers of two.
class Texture {
 public:
  /// `image`: 8UC3, BGR.
  explicit Texture(const cv::Mat& image);

  [[nodiscard]] int width() const { return levels_.front().width; }
  [[nodiscard]] int height() const { return levels_.front().height; }

  /// Returns BGR (0 to 255, fourth lane unused) at (u, v), where the image spans [0, 1), averaged over about
  /// `footprint_px` pixels of the full image.
  [[nodiscard]] Lanes sample(float u, float v, float footprint_px) const;

  /// Returns the sum of four samples. Between two levels, some samples are taken from the finer and some from
  /// the coarser one, in proportion: half the work of blending each.
  [[nodiscard]] Lanes sample_sum(Lanes u, Lanes v, float footprint_px) const;

 private:
  struct Level {
    int width = 0, height = 0;
    std::vector<uint32_t> pixels;  ///< BGRx
  };
  [[nodiscard]] float level_of(float footprint_px) const;
  static Lanes bilinear(const Level& level, float u, float v);

  std::vector<Level> levels_;
};

}  // namespace kinloop::sim
