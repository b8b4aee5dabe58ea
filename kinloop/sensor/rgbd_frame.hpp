#pragma once
// An RGB-D frame: colour and depth at one moment.

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "kinloop/base/ids.hpp"
#include "kinloop/sensor/color_image.hpp"

namespace kinloop {

struct RgbdFrame {
  FrameId id;             ///< index of the frame in its source, from 0
  int64_t stamp_ns = 0;   ///< of the colour image
  ColorImage color;       ///< decoded to BGR only when asked
  cv::Mat depth_m;        ///< 32FC1, z in metres at each pixel of `color`, 0 = unknown
  cv::Mat infrared = {};  ///< 16UC1, as seen by the depth camera; empty unless requested
};

}  // namespace kinloop
