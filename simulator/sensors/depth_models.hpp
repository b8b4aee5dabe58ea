#pragma once
// In: exact depth. Out: the measurements of a stereo camera with a pattern projector, a RealSense D4xx, and
// of a time-of-flight camera, a Kinect 2.

#include <cstdint>

#include "kinloop/core/options.hpp"
#include "kinloop/geometry/camera.hpp"
#include "simulator/render/moment.hpp"
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

/// Returns depth matched between the camera and a second one to its right: 32FC1 metres, 0 = unknown.
/// `disparity_scale` is the focal length times the baseline, px m; `seed` is that of the frame.
cv::Mat matched_depth(const ExactDepth& exact, double disparity_scale, const StereoNoise& noise,
                      uint64_t seed, int threads);

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

/// Returns how much too far each surface seems to a time-of-flight camera with its lamp, because light also
/// reaches it by way of others: the error of range, 32FC1 of the camera's size, m: one reflection on the way,
/// from surfaces that reflect in all directions alike (Jimenez et al. 2014, "Modeling and correction of
/// multipath interference in time of flight cameras"). It rounds concave corners; a plane alone has none.
/// Computed for blocks of pixels and interpolated.
cv::Mat multipath_error_m(const Moment& moment, const PinholeCamera& camera, const SE3& T_room_camera,
                          int threads);

}  // namespace sim
}  // namespace kinloop
