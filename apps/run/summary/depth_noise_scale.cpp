#include <cmath>
#include <numbers>
#include <vector>

#include "apps/run/summary/run_summary.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/optimize/kernels/observation_block.hpp"
#include "kinloop/optimize/pose/camera_observations.hpp"

namespace kinloop {
namespace {

/// The residual of depth of an observation; nullopt without depth, or if the pixel is an outlier.
std::optional<double> depth_residual(const BundleProblem& problem, const BundleObservation& seen) {
  if (!(seen.depth_m > 0) || !std::isfinite(seen.depth_m)) return std::nullopt;
  const Eigen::Vector3d& p_world = problem.p_world[seen.point];
  ObservationBlock block;
  set_measurement(block, 0, seen);
  block.x[0] = p_world.x(), block.y[0] = p_world.y(), block.z[0] = p_world.z();
  const Velocity velocity = problem.velocities.empty() ? Velocity{} : problem.velocities[seen.pose];
  const BlockResiduals r =
      block_residuals(block, {problem.T_world_camera[seen.pose], velocity}, problem.sensor);
  if (!r.is_pixel_inlier(0, problem.sensor.noise.inlier_chi2_pixel) || !std::isfinite(r.depth[0]))
    return std::nullopt;
  return r.depth[0];
}

/// Appends the absolute differences of all pairs, of at most 20 values that are evenly spread.
void append_differences(const std::vector<double>& values, std::vector<double>& differences) {
  constexpr size_t kMaxOfPoint = 20;
  const size_t step = (values.size() + kMaxOfPoint - 1) / kMaxOfPoint;
  for (size_t i = 0; i < values.size(); i += step) {
    for (size_t j = i + step; j < values.size(); j += step)
      differences.push_back(std::abs(values[i] - values[j]));
  }
}

}  // namespace

std::optional<double> depth_noise_scale(const BundleProblem& problem) {
  constexpr size_t kMinPairs = 100;
  constexpr double kMedianOfAbsolute = 0.6745;  // of a normal distribution, standard deviations
  std::vector<std::vector<double>> residuals_of_point(problem.p_world.size());
  for (const BundleObservation& seen : problem.observations) {
    if (const auto residual = depth_residual(problem, seen))
      residuals_of_point[seen.point].push_back(*residual);
  }
  std::vector<double> differences;
  for (const auto& residuals : residuals_of_point) append_differences(residuals, differences);
  if (differences.size() < kMinPairs) return std::nullopt;
  return median(std::move(differences)) / (kMedianOfAbsolute * std::numbers::sqrt2);
}

std::optional<double> depth_noise_scale(const Slam& slam) {
  if (slam.map().keyframes().empty()) return std::nullopt;
  const auto problem =
      make_self_calibration_problem(slam.map(), slam.sensor(), keyframe_velocities(slam.log(), slam.map()));
  return depth_noise_scale(problem.bundle);
}

}  // namespace kinloop
