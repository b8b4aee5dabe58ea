#pragma once
// In: the colour and depth image of one keyframe. Out: its surface as a list of small pieces, and what it saw
// through, both as measured: nothing in it depends on where the keyframe is, so it is made once, while frames
// come, and moves with the keyframe however often that is corrected.

#include <cstdint>
#include <span>
#include <vector>

#include "kinloop/dense/colored_cloud.hpp"
#include "kinloop/dense/keyframe_images.hpp"
#include "kinloop/dense/options.hpp"

namespace kinloop {

/// Steps into which a pixel is divided for the place of a patch's point.
constexpr int kPixelSteps = 64;

/// Steps of the slope of a patch's point.
constexpr float kSlopeSteps = 24;

/// A small piece of surface: the mean of up to 4 x 4 pixels.
struct PatchPoint {
  float inverse_depth = 0;    ///< 1/m
  uint16_t col = 0, row = 0;  ///< in the raw image, steps of a pixel
  Rgb color{};
  uint8_t pixels = 0;               ///< whose mean it is
  int8_t slope_x = 0, slope_y = 0;  ///< relative change of inverse depth along the ray's x / z, y / z; steps
};

/// Side of the squares of pixels by which a patch knows what it saw through.
constexpr int kTilePx = 4;

/// Inverse depth is kept in steps of this, 1/m: a fraction of the sensor's noise.
constexpr double kTileStep_per_m = 1.0 / 3000;

struct DepthPatch {
  float sharpness = 0;  ///< of the colour image
  std::vector<PatchPoint> points;
  std::vector<uint16_t> nearest;  ///< per tile, row by row: its nearest depth; 0 where any pixel is unknown
};

/// The patch of an image that a camera with the given focal length took. Pixels at depth edges, on surfaces
/// seen at a grazing angle and outside the range are no points.
DepthPatch make_patch(const RgbdImages& images, double focal_px, const DenseOptions& options);

/// A patch as bytes, to be kept aside, and back.
std::vector<uint8_t> to_bytes(const DepthPatch& patch);
DepthPatch patch_of_bytes(std::span<const uint8_t> bytes);

}  // namespace kinloop
