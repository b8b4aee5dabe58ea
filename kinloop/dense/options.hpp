#pragma once

#include "kinloop/base/options.hpp"

namespace kinloop {

/// How posed depth images become one coloured cloud.
struct DenseOptions {
  double voxel_m = 0.01;
  int stride_px = 1;
  double min_m = 0.4;
  double max_m = 4.0;
  double max_slope_deg = 78;
  int min_observations = 2;
  int frame_step = 0;
  int jpeg_quality = 95;
  int image_memory_mib = 64;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("voxel_m", self.voxel_m, "edge of a voxel, metres", Range{0.001, 0.5});
    visit("stride_px", self.stride_px, "takes every n-th pixel of every n-th row", Range{1, 16});
    visit("min_m", self.min_m, "nearest depth used, metres", Range{0.05, 10});
    visit("max_m", self.max_m, "farthest depth used, metres", Range{0.1, 13});
    visit("max_slope_deg", self.max_slope_deg,
          "leaves out surfaces that turn away from the ray by more, and with them the flying pixels at depth "
          "edges, degrees",
          Range{10, 89.9});
    visit("min_observations", self.min_observations, "images that must have seen a voxel for it to stay",
          Range{1, 100});
    visit("frame_step", self.frame_step, "beside the keyframes, fuses every n-th frame; 0: keyframes alone",
          Range{0, 10000});
    visit("jpeg_quality", self.jpeg_quality, "of the colour images that are kept for fusing", Range{50, 100});
    visit("image_memory_mib", self.image_memory_mib,
          "memory for the images that are kept for fusing; the rest goes to a temporary file, MiB",
          Range{0, 1e6});
  }
};

}  // namespace kinloop
