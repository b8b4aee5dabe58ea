#pragma once
// In: exact depth and colour. Out: the measurements of a first-generation Kinect.

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/options.hpp"
#include "kinloop/sensor/depth_noise.hpp"
#include "simulator/sensors/exact_depth.hpp"

namespace kinloop {

/// Imperfections of the simulated sensor. Each can be switched off separately.
struct KinectNoise {
  double rolling_shutter_s = 0.030;
  double exposure_s = 0.015;
  double depth_delay_s = 0.015;
  bool depth_stamps = true;
  double depth_noise_per_m = kSensorInverseDepthSigmaPerM;
  double disparity_step_px = 0.125;
  bool holes = true;
  double min_depth_m = 0.5;
  double max_depth_m = 4.5;
  double depth_distortion = 0;
  double image_noise = 2.4;
  double gain_change = 0.08;

  /// An ideal sensor: global shutter, exact depth up to 5 m.
  static KinectNoise none();

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("rolling_shutter_s", self.rolling_shutter_s, "readout time from the first to the last image row, s",
          Range{0, 0.1});
    visit("exposure_s", self.exposure_s, "exposure time of a colour row, s", Range{0, 0.1});
    visit("depth_delay_s", self.depth_delay_s, "delay of depth relative to its stamp, s", Range{-0.1, 0.1});
    visit("depth_stamps", self.depth_stamps,
          "depth has stamps of its own, with drift, jitter and lost images; otherwise those of colour");
    visit("depth_noise_per_m", self.depth_noise_per_m, "k of the depth noise k z^2 metres, 0 = none",
          Range{0, 0.1});
    visit("disparity_step_px", self.disparity_step_px, "quantisation of disparity in pixels, 0 = none",
          Range{0, 4});
    visit("holes", self.holes, "no depth at depth edges, in the projector's shadow and at grazing angles");
    visit("min_depth_m", self.min_depth_m, "depth below this is unknown, m", Range{0, 10});
    visit("max_depth_m", self.max_depth_m, "depth above this is unknown, m", Range{0.1, 13});
    visit("depth_distortion", self.depth_distortion,
          "largest relative depth error of a smooth warp, 0 = none", Range{0, 0.1});
    visit("image_noise", self.image_noise, "grey levels (1 sigma) at mid grey, 0 = none", Range{0, 50});
    visit("gain_change", self.gain_change, "slow relative change of brightness, 0 = none", Range{0, 0.5});
  }
};

namespace sim {

/// Focal length times baseline of the Kinect's infrared pair, pixels times metres: disparity = this / z.
constexpr double kDisparityScale = 0.075 * 525;

/// Returns the standard deviation of disparity noise before quantisation such that both together give the
/// depth noise of the model; px.
double disparity_noise_px(const KinectNoise& noise);

/// Returns measured depth: 32FC1 metres, 0 = unknown. `seed` is that of the frame.
cv::Mat measured_depth(const ExactDepth& exact, const KinectNoise& noise, uint64_t seed, int threads);

/// Returns the brightness factor at a time.
double gain_at(const KinectNoise& noise, double time_s);

/// Adds image noise to an intensity: shot noise grows with the square root of the brightness.
float noisy_level(float level, const KinectNoise& noise, uint32_t random_bits);

}  // namespace sim
}  // namespace kinloop
