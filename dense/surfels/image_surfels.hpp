#pragma once
// In: the colour and depth image of one keyframe. Out: its surfels and observed free space. Both are relative
// to the camera, so they are extracted once, while frames arrive, and follow the keyframe when its pose is
// corrected.

#include <cstdint>
#include <span>
#include <vector>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/image_store.hpp"
#include "dense/options.hpp"
#include "kinloop/sensor/depth_noise.hpp"

namespace kinloop {

/// Quantisation steps of a surfel's slope.
constexpr float kSlopeSteps = 24;

/// A small surface element: the mean of up to 4 x 4 pixels.
struct Surfel {
  float inverse_depth = 0;    ///< 1/m
  uint16_t col = 0, row = 0;  ///< in the raw image, in steps of 1 / ImageSurfels::pixel_steps pixel
  Rgb color{};
  uint8_t pixels = 0;  ///< number of pixels averaged
  int8_t slope_x = 0,
         slope_y = 0;  ///< relative change of inverse depth along the ray's x / z and y / z; in steps
};

/// Side of the square tiles in which free space is recorded.
constexpr int kTilePx = 4;

/// Quantisation step of inverse depth, 1/m: a fraction of the sensor's noise.
constexpr double kTileStep_per_m = 1.0 / 3000;

struct ImageSurfels {
  float sharpness = 0;   ///< of the colour image
  int pixel_steps = 64;  ///< subpixel steps of positions
  std::vector<Surfel> points;
  std::vector<uint16_t> nearest;  ///< per tile, row-major: its nearest depth; 0 if any pixel is unknown
};

/// What the extraction of surfels needs to know of the camera.
struct SurfelCamera {
  double focal_px = 0;
  DepthNoise noise = {};
};

/// Extracts the surfels of an image. Pixels at depth edges, on surfaces at
/// grazing incidence or out of range are skipped.
ImageSurfels extract_surfels(const RgbdImages& images, const SurfelCamera& camera,
                             const DenseOptions& options);

/// Returns at most `max_points` of the surfels, evenly spread, without the nearest depths.
ImageSurfels thinned(const ImageSurfels& surfels, size_t max_points);

/// Serialises surfels to bytes, and back.
std::vector<uint8_t> to_bytes(const ImageSurfels& surfels);
ImageSurfels surfels_from_bytes(std::span<const uint8_t> bytes);

}  // namespace kinloop
