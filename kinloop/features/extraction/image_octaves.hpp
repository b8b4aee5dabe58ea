#pragma once
// An image pyramid with ratio 2, for patch alignment.

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Element `o` is the image (8UC1) reduced `o` times by 2, by averaging 2x2 pixels; element 0 is the image
/// itself.
using ImageOctaves = std::vector<cv::Mat>;

/// Builds up to `count` octaves, fewer if the image is small.
ImageOctaves make_octaves(const cv::Mat& gray, int count);

/// Position on an octave of a pixel of the full image.
inline Eigen::Vector2d to_octave(const Eigen::Vector2d& pixel, int octave) {
  return (pixel.array() + 0.5) / (1 << octave) - 0.5;
}

/// Pixel of the full image at a position on an octave; the inverse of `to_octave`.
inline Eigen::Vector2d from_octave(const Eigen::Vector2d& position, int octave) {
  return (position.array() + 0.5) * (1 << octave) - 0.5;
}

}  // namespace kinloop
