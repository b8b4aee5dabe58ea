#pragma once
// The options of the live view.

#include "dense/options.hpp"
#include "kinloop/core/options.hpp"

namespace kinloop {

/// What of a run is shown, and how finely.
struct ViewerOptions {
  double voxel_m = 0.015;
  bool mesh = true;
  double image_rate_hz = 10;
  int image_width_px = 320;
  int jpeg_quality = 80;
  bool paused = false;
  DepthLimits limits = {};  ///< not options of their own: the program takes those of the dense map

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("voxel_m", self.voxel_m, "voxel size of the live cloud and, from 0.01 on, of the live mesh, metres",
          Range{0.002, 0.5});
    visit("mesh", self.mesh, "whether a mesh is made during the run, for the viewer");
    visit("image_rate_hz", self.image_rate_hz, "camera images per second while a browser is connected",
          Range{0.1, 60});
    visit("image_width_px", self.image_width_px, "width of the camera images", Range{32, 1920}, Expert{});
    visit("jpeg_quality", self.jpeg_quality, "JPEG quality of the camera images", Range{10, 100}, Expert{});
    visit("paused", self.paused, "start paused, until a browser resumes the run");
  }
};

}  // namespace kinloop
