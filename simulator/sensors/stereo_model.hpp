#pragma once
// In: exact depth. Out: the measurements of a stereo camera with a pattern projector, a RealSense D4xx.

#include <cstdint>

#include "kinloop/core/options.hpp"
#include "simulator/sensors/exact_depth.hpp"

namespace kinloop {

/// Imperfections of simulated stereo. Each can be switched off separately.
struct StereoNoise {
  double disparity_noise_px = 0.08;
  double disparity_step_px = 1.0 / 32;
  int window_px = 7;
  bool fattening = true;
  double min_contrast = 0.02;
  bool holes = true;
  double min_depth_m = 0.2;
  double max_depth_m = 10;

  /// An ideal sensor: exact depth up to 5 m.
  static StereoNoise none();

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("disparity_noise_px", self.disparity_noise_px, "noise of disparity with its quantisation, px",
          Range{0, 2});
    visit("disparity_step_px", self.disparity_step_px, "quantisation of disparity in pixels, 0 = none",
          Range{0, 4});
    visit("window_px", self.window_px, "width of the matching window, within which noise is correlated",
          Range{1, 31});
    visit("fattening", self.fattening, "near objects are half a window too wide");
    visit("min_contrast", self.min_contrast,
          "surfaces whose texture and projected pattern have less contrast have no depth", Range{0, 1});
    visit("holes", self.holes, "no depth where the second camera does not see, and at grazing angles");
    visit("min_depth_m", self.min_depth_m, "depth below this is unknown, m", Range{0, 10});
    visit("max_depth_m", self.max_depth_m, "depth above this is unknown, m", Range{0.1, 50});
  }
};

namespace sim {

/// Returns depth matched between the camera and a second one to its right: 32FC1 metres, 0 = unknown.
/// `disparity_scale` is the focal length times the baseline, px m; `seed` is that of the frame.
cv::Mat matched_depth(const ExactDepth& exact, double disparity_scale, const StereoNoise& noise,
                      uint64_t seed, int threads);

}  // namespace sim
}  // namespace kinloop
