#pragma once

#include "kinloop/base/options.hpp"

namespace kinloop {

/// What of a run is shown, and how finely.
struct ViewerOptions {
  double voxel_m = 0.015;
  double max_m = 4.0;
  double images_hz = 10;
  int image_width_px = 320;
  int jpeg_quality = 80;
  int min_shared = 60;
  int max_neighbors = 5;
  bool paused = false;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("voxel_m", self.voxel_m, "the live cloud has one point per voxel of this edge, metres",
          Range{0.002, 0.5});
    visit("max_m", self.max_m, "farthest depth shown, metres", Range{0.1, 13});
    visit("images_hz", self.images_hz, "camera images a second, while a browser watches", Range{0.1, 60});
    visit("image_width_px", self.image_width_px, "width of the camera images", Range{32, 1920});
    visit("jpeg_quality", self.jpeg_quality, "of the camera images", Range{10, 100});
    visit("min_shared", self.min_shared,
          "shared landmarks from which on two keyframes are drawn as covisible", Range{1, 1000});
    visit("max_neighbors", self.max_neighbors, "covisible keyframes drawn per keyframe, the closest",
          Range{0, 100});
    visit("paused", self.paused, "wait before the first frame until a browser says to go on");
  }
};

}  // namespace kinloop
