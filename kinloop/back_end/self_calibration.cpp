#include "kinloop/back_end/self_calibration.hpp"

#include <algorithm>
#include <cmath>

namespace kinloop {
namespace {

/// Returns the estimate of the parameters that were free.
SensorEstimate estimate_of(const BundleProblem& problem, const BundleSolution& solution) {
  SensorEstimate estimate = nominal_estimate(problem.sensor);
  estimate.nominal = problem.prior.mean;
  estimate.sensor.corrections = solution.corrections;
  for (const int k : problem.prior.free_parameters()) {
    estimate.sigma(k) = std::sqrt(std::max(solution.sensor_covariance(k, k), 0.0));
    estimate.used[static_cast<size_t>(k)] = solution.sensor_free[static_cast<size_t>(k)];
  }
  return estimate;
}

SensorPrior wide_time_prior(const SensorEstimate& nominal, const SelfCalibrationOptions& options) {
  SensorPrior prior;
  prior.mean = nominal.nominal;
  prior.max_sigma_ratio = options.max_sigma_ratio;
  prior.min_sigmas = options.min_sigmas;
  for (int k = 0; k < kSensorParameterCount; ++k)
    prior.typical.at(static_cast<size_t>(k)) = nominal.typical_sigma(k) > 0;
  if (options.enabled)
    prior.sigma(kRollingShutter) = prior.sigma(kDepthShutter) = prior.sigma(kDepthDelay) =
        options.time_sigma_s;
  return prior;
}

}  // namespace

SensorPrior sensor_prior(const SensorEstimate& nominal, const SelfCalibrationOptions& options) {
  SensorPrior prior = wide_time_prior(nominal, options);
  if (!options.enabled) return prior;
  const PinholeCamera& camera = nominal.sensor.camera;
  SensorVector& sigma = prior.sigma;
  sigma(kFocalX) = options.focal_sigma * camera.fx;
  sigma(kFocalY) = options.focal_sigma * camera.fy;
  sigma(kCenterX) = sigma(kCenterY) = options.center_sigma_px;
  sigma(kRadial1) = sigma(kRadial2) = options.radial_sigma;
  for (int k = kInverseDepthBias; k <= kInverseDepthBiasYY; ++k)
    sigma(k) = options.inverse_depth_bias_sigma_per_m;
  return prior;
}

SensorPrior time_prior(const SensorEstimate& nominal, const SelfCalibrationOptions& options) {
  SensorPrior prior = wide_time_prior(nominal, options);
  for (const int k : prior.free_parameters()) {
    if (prior.typical.at(static_cast<size_t>(k)))
      prior.sigma(k) = std::min(prior.sigma(k), nominal.typical_sigma(k));
  }
  return prior;
}

BundleAdjustmentProblem make_self_calibration_problem(const Map& map, const Sensor& sensor,
                                                      std::vector<Velocity> velocities) {
  BundleAdjustmentProblem problem = make_global_ba_problem(map, sensor, MeasurementKind::kRaw);
  problem.bundle.velocities = std::move(velocities);
  return problem;
}

SelfCalibrationResult run_self_calibration(const BundleAdjustmentProblem& problem,
                                           const BundleOptions& options) {
  BundleSolution solution = solve_bundle(problem.bundle, options);
  return {make_map_update(problem, solution), estimate_of(problem.bundle, solution),
          std::move(solution.pose_covariance), solution.residual_variance, solution.residual_clustering};
}

}  // namespace kinloop
