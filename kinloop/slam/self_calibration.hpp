#pragma once
// What the sensor does that its calibration does not say: readout time of the shutter, delay of the depth
// image, lens, depth. In: map and frames. Out: the corrections that the data narrow down, with the map
// adjusted to them. While frames come only the times are estimated, because tracking needs them most and they
// cannot bend the map; at the end everything is.

#include "kinloop/base/options.hpp"
#include "kinloop/mapping/bundle_adjustment.hpp"
#include "kinloop/slam/frame_velocities.hpp"

namespace kinloop {

struct SelfCalibrationOptions {
  bool enabled = true;
  int min_keyframes = 10;
  int passes = 3;
  double focal_sigma = 0.003;
  double center_sigma_px = 5;
  double radial_sigma = 0.05;
  double time_sigma_s = 0.03;
  double depth_offset_sigma_per_m = 0.002;
  double max_sigma_ratio = 0.4;
  double min_sigmas = 3;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("enabled", self.enabled, "estimate readout times, depth delay, intrinsics and depth distortion");
    visit("min_keyframes", self.min_keyframes,
          "keyframes after which readout time and depth delay are first estimated, and again at every "
          "doubling",
          Range{2, 100000});
    visit("passes", self.passes, "alternating passes over sensor, map and frame poses at the end",
          Range{1, 10}, Expert{});
    visit("focal_sigma", self.focal_sigma, "prior on the focal length (1 sigma), relative", Range{0, 1},
          Expert{});
    visit("center_sigma_px", self.center_sigma_px, "prior on the principal point (1 sigma), px",
          Range{0, 1000}, Expert{});
    visit("radial_sigma", self.radial_sigma, "prior on the radial distortion coefficients (1 sigma)",
          Range{0, 10}, Expert{});
    visit("time_sigma_s", self.time_sigma_s, "prior on readout times and depth delay (1 sigma), s",
          Range{0, 1}, Expert{});
    visit("depth_offset_sigma_per_m", self.depth_offset_sigma_per_m,
          "prior on the inverse depth distortion (1 sigma), 1/m", Range{0, 1}, Expert{});
    visit("max_sigma_ratio", self.max_sigma_ratio,
          "accept a parameter if its posterior sigma is below this fraction of its prior sigma", Range{0, 1},
          Expert{});
    visit("min_sigmas", self.min_sigmas,
          "... and if it differs from the nominal value by at least this many standard deviations",
          Range{0, 100}, Expert{});
  }
};

/// What the sensor was found to do; as known beforehand for parameters that the data do not constrain.
struct SensorEstimate {
  SensorVector value = SensorVector::Zero();
  SensorVector sigma =
      SensorVector::Zero();  ///< standard deviation; of the held ones what it would have been
  std::vector<bool> used = std::vector<bool>(kSensorParameterCount, false);
};

/// What camera.yaml says of the sensor's times. The depth image is taken to be read out as the colour image
/// is.
SensorVector nominal_sensor(const RgbdCamera& camera);

/// `camera` with what was found of it worked in: lens and times. A deformation of depth is left out, since
/// camera.yaml has no place for it.
RgbdCamera calibrated_camera(const RgbdCamera& camera, const SensorEstimate& sensor);

/// How far each parameter may be off what is known; 0 = held. The scale of depth is that of the world and
/// cannot be found.
SensorVector prior_sigmas(const PinholeCamera& camera, const SelfCalibrationOptions& options);

/// The same for the readout times and the depth delay alone.
SensorVector prior_time_sigmas(const SelfCalibrationOptions& options);

/// The whole map with everything as it was measured, by keyframes that move with `velocities`; the sensor
/// starts at `value`.
BundleAdjustmentProblem make_self_calibration_problem(const Map& map, const RgbdCamera& camera,
                                                      std::vector<Velocity> velocities,
                                                      const SensorVector& value);

/// `estimate`, with what was known `before` of the parameters that were held this time.
SensorEstimate with_fixed_from(SensorEstimate estimate, const SensorEstimate& before);

/// A map adjusted together with its sensor.
struct SelfCalibrationResult {
  MapUpdate update;
  SensorEstimate sensor;
  std::vector<Matrix6d> pose_covariance;  ///< per pose of the problem, where the options ask for it
};

/// Solves the problem with the sensor free within `expected`, then again without the parameters that the data
/// told too little about, or nothing new.
SelfCalibrationResult run_self_calibration(BundleAdjustmentProblem problem, const SensorVector& expected,
                                           const SelfCalibrationOptions& calibration,
                                           const BundleOptions& options);

}  // namespace kinloop
