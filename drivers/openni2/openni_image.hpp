#pragma once
// In: images and fields of view as OpenNI gives them, from a device or a recording. Out: kinloop's images and
// camera.

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/images/color_image.hpp"

namespace kinloop {

/// Formats of pixels, numbered as in OpenNI 2.
enum class OpenNiPixels : uint64_t {
  kDepth1Mm = 100,
  kDepth100Um = 101,
  kRgb = 200,
  kUyvy = 201,
  kGray = 202,
  kJpeg = 204,
  kYuyv = 205
};

/// Does not own the data.
struct OpenNiImage {
  int width = 0, height = 0;
  size_t stride = 0;  ///< bytes per row; unused for JPEG
  OpenNiPixels pixels = OpenNiPixels::kRgb;
  bool mirrored = false;
  Bytes data;
};

/// Returns the image, unmirrored. Throws InputError for other formats, another size and truncated data.
ColorImage color_from(const OpenNiImage& image);

/// Returns depth in metres (32FC1), unmirrored. Throws InputError for other formats and truncated data.
cv::Mat depth_from(const OpenNiImage& image);

/// OpenNI's camera model: a field of view in each direction, the principal point in the middle, no
/// distortion. Throws InputError that names `source` if the fields of view are not between 0 and pi.
PinholeCamera camera_with_view(const std::string& source, cv::Size size, double horizontal_rad,
                               double vertical_rad);

}  // namespace kinloop
