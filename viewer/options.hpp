#pragma once

#include "kinloop/base/options.hpp"

namespace kinloop {

/// What of a run is shown, and how finely.
struct ViewerOptions {
  double voxel_m = 0.015;
  double max_depth_m = 4.0;
  double image_rate_hz = 10;
  int image_width_px = 320;
  int jpeg_quality = 80;
  int min_shared_landmarks = 60;
  int max_neighbors = 5;
  bool paused = false;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("voxel_m", self.voxel_m, "voxel size of the live cloud, metres", Range{0.002, 0.5});
    visit("max_depth_m", self.max_depth_m, "maximum depth shown, metres", Range{0.1, 13});
    visit("image_rate_hz", self.image_rate_hz, "camera images per second while a browser is connected",
          Range{0.1, 60});
    visit("image_width_px", self.image_width_px, "width of the camera images", Range{32, 1920});
    visit("jpeg_quality", self.jpeg_quality, "JPEG quality of the camera images", Range{10, 100});
    visit("min_shared_landmarks", self.min_shared_landmarks,
          "minimum shared landmarks for a covisibility edge to be drawn", Range{1, 1000});
    visit("max_neighbors", self.max_neighbors, "maximum covisibility edges drawn per keyframe",
          Range{0, 100});
    visit("paused", self.paused, "start paused, until a browser resumes the run");
  }
};

}  // namespace kinloop
