#pragma once
// In: a colour image and its depth. Out: the same in few bytes, as a run keeps them and as map files hold
// them.

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/sensor/images/color_image.hpp"

namespace kinloop {

struct ImageEncoding {
  double depth_scale = 5000;  ///< units per metre of stored depth, as those of the camera
  int jpeg_quality = 95;
};

/// A colour image and its depth.
struct RgbdImages {
  cv::Mat color;    ///< 8UC3, BGR
  cv::Mat depth_m;  ///< 32FC1, 0 = unknown
};

/// Compressed images: colour as JPEG, depth by `pack_depth`.
struct EncodedImages {
  int rows = 0, cols = 0;
  std::vector<uint8_t> color;
  std::vector<uint8_t> depth;

  bool operator==(const EncodedImages&) const = default;
};

/// Compressed images, and what decoding them gives.
struct StoredImages {
  EncodedImages encoded;
  RgbdImages decoded;
};

/// Compresses images. Colour that came as JPEG stays as it is. Depth is rounded to the units of
/// `encoding.depth_scale`; values out of their range become unknown.
StoredImages encode_images(const ColorImage& color, const cv::Mat& depth_m, const ImageEncoding& encoding);

/// Images that are damaged are black and of unknown depth.
RgbdImages decode_images(const EncodedImages& images, const ImageEncoding& encoding);

/// Returns whether the size of compressed images is that in the header of their colour, and their depth can
/// be unpacked.
bool is_decodable(const EncodedImages& images);

}  // namespace kinloop
