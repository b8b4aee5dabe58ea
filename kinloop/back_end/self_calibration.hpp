#pragma once
// Self-calibration: estimates sensor parameters missing from the calibration (shutter readout time, depth
// delay, lens, depth) from the map and frames, with the map adjusted to them. Parameters that the data do not
// constrain stay fixed. During the run only the times are estimated: tracking depends on them most and they
// cannot deform the map. The final adjustment estimates all parameters.

#include "kinloop/core/options.hpp"
#include "kinloop/map/frames/frame_velocities.hpp"
#include "kinloop/mapping/bundle_adjustment.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"

namespace kinloop {

struct SelfCalibrationOptions {
  bool enabled = true;
  int min_keyframes = 6;
  int max_keyframes = 200;
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
    visit("max_keyframes", self.max_keyframes,
          "largest map in which they are estimated during the run: its copy delays a frame", Range{0, 1e6},
          Expert{});
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

/// Returns the prior of each correction around its nominal value. The depth scale is fixed, because it is the
/// scale of the world and not observable.
SensorPrior sensor_prior(const SensorEstimate& nominal, const SelfCalibrationOptions& options);

/// Returns the prior with only the readout times and depth delay free. During the run, when few keyframes are
/// known, a readout that is typical of the sensor is left only within its spread.
SensorPrior time_prior(const SensorEstimate& nominal, const SelfCalibrationOptions& options);

/// Returns the problem of the whole map with raw measurements, for keyframes that move with `velocities`. The
/// corrections start at those of `sensor`; their prior must be filled in.
BundleAdjustmentProblem make_self_calibration_problem(const Map& map, const Sensor& sensor,
                                                      std::vector<Velocity> velocities);

/// A map adjusted together with its sensor.
struct SelfCalibrationResult {
  MapUpdate update;
  SensorEstimate sensor;
  std::vector<Matrix6d> pose_covariance;  ///< per pose of the problem, if requested in the options
  double residual_variance = 0;           ///< with them, see BundleSolution
  double residual_clustering = 1;         ///< likewise
};

/// Solves the problem with the corrections free within its prior. After the first round, corrections that the
/// data constrain too little or do not change are fixed.
SelfCalibrationResult run_self_calibration(const BundleAdjustmentProblem& problem,
                                           const BundleOptions& options);

}  // namespace kinloop
