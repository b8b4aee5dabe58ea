#pragma once
// Self-calibration: estimates sensor parameters missing from the calibration (shutter readout time, depth
// delay, lens, depth) from the map and frames, with the map adjusted to them. Parameters that the data do not
// constrain stay fixed. During the run only the times are estimated: tracking depends on them most and they
// cannot deform the map. The final adjustment estimates all parameters.

#include "kinloop/core/options.hpp"
#include "kinloop/mapping/bundle_adjustment.hpp"
#include "kinloop/sensor/rgbd_camera.hpp"
#include "kinloop/tracking/frame_velocities.hpp"

namespace kinloop {

struct SelfCalibrationOptions {
  bool enabled = true;
  int min_keyframes = 10;
  int passes = 3;
  double focal_sigma = 0.003;
  double center_sigma_px = 5;
  double radial_sigma = 0.05;
  double time_sigma_s = 0.03;
  double inverse_depth_bias_sigma_per_m = 0.002;
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
    visit("inverse_depth_bias_sigma_per_m", self.inverse_depth_bias_sigma_per_m,
          "prior on the inverse depth distortion (1 sigma), 1/m", Range{0, 1}, Expert{});
    visit("max_sigma_ratio", self.max_sigma_ratio,
          "accept a parameter only if its posterior sigma is below this fraction of its prior sigma",
          Range{0, 1}, Expert{});
    visit("min_sigmas", self.min_sigmas,
          "accept a parameter only if it differs from its nominal value by at least this many standard "
          "deviations",
          Range{0, 100}, Expert{});
  }
};

/// Estimated sensor parameters. Parameters that the data do not constrain keep their prior value.
struct SensorEstimate {
  SensorVector value = SensorVector::Zero();
  SensorVector sigma =
      SensorVector::Zero();  ///< standard deviation; for fixed parameters the value it would have had
  std::vector<bool> used = std::vector<bool>(kSensorParameterCount, false);
};

/// Returns the sensor times of camera.yaml. The depth image is assumed to have the readout time of the colour
/// image.
SensorVector nominal_sensor(const RgbdCamera& camera);

/// Returns `camera` with the estimated lens and times. Omits the depth distortion, which camera.yaml cannot
/// represent.
RgbdCamera calibrated_camera(const RgbdCamera& camera, const SensorEstimate& sensor);

/// Returns the prior standard deviation of each parameter; 0 = fixed. The depth scale is fixed, because it is
/// the scale of the world and not observable.
SensorVector prior_sigmas(const PinholeCamera& camera, const SelfCalibrationOptions& options);

/// Returns the prior standard deviations for the readout times and depth delay; 0 for all other parameters.
SensorVector prior_time_sigmas(const SelfCalibrationOptions& options);

/// Returns the problem of the whole map with raw measurements, for keyframes that move with `velocities`. The
/// sensor starts at `value`.
BundleAdjustmentProblem make_self_calibration_problem(const Map& map, const RgbdCamera& camera,
                                                      std::vector<Velocity> velocities,
                                                      const SensorVector& value);

/// Returns `estimate`, with the parameters that were fixed this time taken from `before`.
SensorEstimate with_fixed_from(SensorEstimate estimate, const SensorEstimate& before);

/// A map adjusted together with its sensor.
struct SelfCalibrationResult {
  MapUpdate update;
  SensorEstimate sensor;
  std::vector<Matrix6d> pose_covariance;  ///< per pose of the problem, if requested in the options
};

/// Solves the problem with the sensor parameters free within the prior `expected`. After the first round,
/// those are fixed that the data constrain too little or do not change.
SelfCalibrationResult run_self_calibration(BundleAdjustmentProblem problem, const SensorVector& expected,
                                           const SelfCalibrationOptions& calibration,
                                           const BundleOptions& options);

}  // namespace kinloop
