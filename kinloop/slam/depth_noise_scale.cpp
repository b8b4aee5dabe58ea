#include "kinloop/slam/depth_noise_scale.hpp"

#include <cmath>
#include <vector>

#include "kinloop/base/quantile.hpp"
#include "kinloop/optimize/kernels/observation_block.hpp"
#include "kinloop/optimize/pose/camera_observations.hpp"

namespace kinloop {
namespace {

/// The residual of depth of an observation; nullopt without depth, or if the pixel is an outlier.
std::optional<double> depth_residual(const BundleProblem& problem, const BundleObservation& seen,
                                     const MeasurementModel& model, double inlier_chi2_pixel) {
  if (!(seen.depth_m > 0) || !std::isfinite(seen.depth_m)) return std::nullopt;
  const Eigen::Vector3d& p_world = problem.p_world[seen.point];
  ObservationBlock block;
  set_measurement(block, 0, seen);
  block.x[0] = p_world.x(), block.y[0] = p_world.y(), block.z[0] = p_world.z();
  const Velocity velocity = problem.velocities.empty() ? Velocity{} : problem.velocities[seen.pose];
  const BlockResiduals r = block_residuals(block, {problem.T_world_camera[seen.pose], velocity}, model);
  if (!r.is_pixel_inlier(0, inlier_chi2_pixel) || !std::isfinite(r.depth[0])) return std::nullopt;
  return r.depth[0];
}

}  // namespace

std::optional<double> depth_noise_scale(const BundleProblem& problem, const SensorVector& sensor,
                                        const BundleOptions& options) {
  constexpr size_t kMinOfPoint = 3, kMinInAll = 100;
  constexpr double kMedianOfAbsolute = 0.6745;  // of a normal distribution, standard deviations
  const MeasurementModel model{problem.camera, sensor, options.depth_noise, options.robust_width};
  std::vector<std::vector<double>> residuals_of_point(problem.p_world.size());
  for (const BundleObservation& seen : problem.observations) {
    if (const auto residual = depth_residual(problem, seen, model, options.inlier_chi2_pixel))
      residuals_of_point[seen.point].push_back(std::abs(*residual));
  }
  std::vector<double> absolute;
  for (const auto& residuals : residuals_of_point) {
    if (residuals.size() < kMinOfPoint) continue;
    // The point was fitted to its n depths, which takes one degree of freedom from them.
    const auto n = static_cast<double>(residuals.size());
    for (const double residual : residuals) absolute.push_back(residual * std::sqrt(n / (n - 1)));
  }
  if (absolute.size() < kMinInAll) return std::nullopt;
  return median(std::move(absolute)) / kMedianOfAbsolute;
}

std::optional<double> depth_noise_scale(const Slam& slam, const RgbdCamera& camera) {
  if (slam.map().keyframes().empty()) return std::nullopt;
  const SensorVector& sensor = slam.sensor().value;
  const auto problem =
      make_self_calibration_problem(slam.map(), camera, keyframe_velocities(slam.log(), slam.map()), sensor);
  return depth_noise_scale(problem.bundle, sensor, slam.options().global_ba);
}

}  // namespace kinloop
