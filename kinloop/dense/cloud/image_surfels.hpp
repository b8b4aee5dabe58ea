#pragma once
// In: the colour and depth image of one keyframe. Out: its surface as a list of small pieces, and what it saw
// through, both as measured: nothing in it depends on where the keyframe is, so it is made once, while frames
// come, and moves with the keyframe however often that is corrected.

#include <cstdint>
#include <span>
#include <vector>

#include "kinloop/dense/cloud/colored_cloud.hpp"
#include "kinloop/dense/image_store.hpp"
#include "kinloop/dense/options.hpp"

namespace kinloop {

/// Subpixel steps of a surfel's image position.
constexpr int kPixelSteps = 64;

/// Quantisation steps of a surfel's slope.
constexpr float kSlopeSteps = 24;

/// A small piece of surface: the mean of up to 4 x 4 pixels.
struct Surfel {
  float inverse_depth = 0;    ///< 1/m
  uint16_t col = 0, row = 0;  ///< in the raw image, steps of a pixel
  Rgb color{};
  uint8_t pixels = 0;               ///< whose mean it is
  int8_t slope_x = 0, slope_y = 0;  ///< relative change of inverse depth along the ray's x / z, y / z; steps
};

/// Side of the square tiles in which free space is recorded.
constexpr int kTilePx = 4;

/// Inverse depth is kept in steps of this, 1/m: a fraction of the sensor's noise.
constexpr double kTileStep_per_m = 1.0 / 3000;

struct ImageSurfels {
  float sharpness = 0;  ///< of the colour image
  std::vector<Surfel> points;
  std::vector<uint16_t> nearest;  ///< per tile, row by row: its nearest depth; 0 where any pixel is unknown
};

/// The surfels of an image that a camera with the given focal length took. Pixels at depth edges, on surfaces
/// seen at a grazing angle and outside the range are no points.
ImageSurfels extract_surfels(const RgbdImages& images, double focal_px, const DenseOptions& options);

/// Serialises surfels to bytes, and back.
std::vector<uint8_t> to_bytes(const ImageSurfels& surfels);
ImageSurfels surfels_from_bytes(std::span<const uint8_t> bytes);

}  // namespace kinloop
