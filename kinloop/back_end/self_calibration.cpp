#include "kinloop/back_end/self_calibration.hpp"

#include <algorithm>
#include <cmath>

namespace kinloop {
namespace {

/// Returns the estimate of the parameters that were free within the prior `expected`.
SensorEstimate estimate_of(const BundleSolution& solution, const SensorVector& expected) {
  SensorEstimate estimate;
  estimate.value = solution.sensor;
  for (int k = 0; k < kSensorParameterCount; ++k) {
    if (expected(k) == 0) continue;
    estimate.sigma(k) = std::sqrt(std::max(solution.sensor_covariance(k, k), 0.0));
    estimate.used[static_cast<size_t>(k)] = solution.sensor_free[static_cast<size_t>(k)];
  }
  return estimate;
}

}  // namespace

SensorEstimate with_fixed_from(SensorEstimate estimate, const SensorEstimate& before) {
  for (int k = 0; k < kSensorParameterCount; ++k) {
    if (estimate.sigma(k) > 0) continue;  // this parameter was estimated
    estimate.sigma(k) = before.sigma(k);
    estimate.used[static_cast<size_t>(k)] = before.used[static_cast<size_t>(k)];
  }
  return estimate;
}

SensorVector nominal_sensor(const RgbdCamera& camera) {
  SensorVector known = SensorVector::Zero();
  known(kRollingShutter) = known(kDepthShutter) = camera.rolling_shutter_s;
  known(kDepthDelay) = camera.depth_delay_s;
  return known;
}

RgbdCamera calibrated_camera(const RgbdCamera& camera, const SensorEstimate& sensor) {
  RgbdCamera calibrated = camera;
  const bool lens_found =
      std::any_of(sensor.used.begin(), sensor.used.begin() + kRollingShutter, [](bool used) { return used; });
  if (lens_found) calibrated.color = corrected_camera(camera.color, sensor.value);
  calibrated.rolling_shutter_s = sensor.value(kRollingShutter);
  calibrated.depth_delay_s = sensor.value(kDepthDelay);
  return calibrated;
}

SensorVector prior_time_sigmas(const SelfCalibrationOptions& options) {
  SensorVector sigma = SensorVector::Zero();
  if (options.enabled)
    sigma(kRollingShutter) = sigma(kDepthShutter) = sigma(kDepthDelay) = options.time_sigma_s;
  return sigma;
}

SensorVector prior_sigmas(const PinholeCamera& camera, const SelfCalibrationOptions& options) {
  SensorVector sigma = prior_time_sigmas(options);
  if (!options.enabled) return sigma;
  sigma(kFocalX) = options.focal_sigma * camera.fx;
  sigma(kFocalY) = options.focal_sigma * camera.fy;
  sigma(kCenterX) = sigma(kCenterY) = options.center_sigma_px;
  sigma(kRadial1) = sigma(kRadial2) = options.radial_sigma;
  for (int k = kInverseDepthBias; k <= kInverseDepthBiasYY; ++k)
    sigma(k) = options.inverse_depth_bias_sigma_per_m;
  return sigma;
}

BundleAdjustmentProblem make_self_calibration_problem(const Map& map, const RgbdCamera& camera,
                                                      std::vector<Velocity> velocities,
                                                      const SensorVector& value) {
  BundleAdjustmentProblem problem = make_global_ba_problem(map, camera.color, MeasurementKind::kRaw);
  problem.bundle.velocities = std::move(velocities);
  problem.bundle.sensor.value = value;
  problem.bundle.sensor.prior_mean = nominal_sensor(camera);
  return problem;
}

SelfCalibrationResult run_self_calibration(BundleAdjustmentProblem problem, const SensorVector& expected,
                                           const SelfCalibrationOptions& calibration,
                                           const BundleOptions& options) {
  SensorCalibration& sensor = problem.bundle.sensor;
  sensor.prior_sigma = expected;
  sensor.max_sigma_ratio = calibration.max_sigma_ratio;
  sensor.min_sigmas = calibration.min_sigmas;
  BundleSolution solution = solve_bundle(problem.bundle, options);
  return {make_map_update(problem, solution), estimate_of(solution, expected),
          std::move(solution.pose_covariance)};
}

}  // namespace kinloop
