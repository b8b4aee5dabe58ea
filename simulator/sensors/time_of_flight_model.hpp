#pragma once
// In: exact depth. Out: the measurements of a time-of-flight camera, a Kinect 2.

#include <cstdint>

#include "kinloop/core/options.hpp"
#include "simulator/sensors/exact_depth.hpp"

namespace kinloop {

/// Imperfections of simulated time of flight. Each can be switched off separately.
///
/// Noise: 1.2 mm and 0.25 mm / m^2, added in quadrature, near the law that Fankhauser et al. 2015 ("Kinect v2
/// for mobile robot navigation") give head-on: 1.3, 1.7, 2.7, 4.3 mm at 1, 2, 3, 4 m (from memory, not
/// checked again).
struct TimeOfFlightNoise {
  double noise_floor_m = 1.2e-3;
  double noise_per_m = 0.25e-3;
  double max_noise_m = 0.05;
  bool flying_pixels = true;
  bool multipath = true;
  double min_depth_m = 0.5;
  double max_depth_m = 4.5;

  /// An ideal sensor: exact depth up to 5 m.
  static TimeOfFlightNoise none();

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("noise_floor_m", self.noise_floor_m, "noise of near depth, m", Range{0, 0.1});
    visit("noise_per_m", self.noise_per_m,
          "k of the noise k z^2 metres of a white surface; k z^2 / (reflectance cos(incidence)) of others",
          Range{0, 0.1});
    visit("max_noise_m", self.max_noise_m, "depth noisier than this is unknown, m", Range{0.001, 10});
    visit("flying_pixels", self.flying_pixels, "depth between both surfaces in pixels that see two");
    visit("multipath", self.multipath,
          "depth too large in concave corners, which also receive light from other surfaces");
    visit("min_depth_m", self.min_depth_m, "depth below this is unknown, m", Range{0, 10});
    visit("max_depth_m", self.max_depth_m, "depth above this is unknown, m", Range{0.1, 18});
  }
};

namespace sim {

/// Range at which the phase of the light repeats: the three frequencies of a Kinect 2 (16, 80 and 120 MHz,
/// Sell and O'Connor 2014, "The Xbox One system on a chip and Kinect sensor") together have a period of 8
/// MHz.
constexpr double kUnambiguousRange_m = 299'792'458.0 / (2 * 8e6);

/// What a time-of-flight camera's pixels look at. Mats have the size of the image.
struct TimeOfFlightRays {
  ExactDepth exact;         ///< of one or four samples per pixel; with reflectance
  cv::Mat range_per_depth;  ///< length of the ray at depth 1
  cv::Mat range_error_m;    ///< by multipath; empty for none
};

/// Returns measured depth: 32FC1 metres, 0 = unknown. `seed` is that of the frame.
cv::Mat measured_depth(const TimeOfFlightRays& view, const TimeOfFlightNoise& noise, uint64_t seed,
                       int threads);

}  // namespace sim
}  // namespace kinloop
