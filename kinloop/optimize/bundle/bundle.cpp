#include "kinloop/optimize/bundle/bundle.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/core/errors.hpp"
#include "kinloop/optimize/bundle/bundle_model.hpp"
#include "kinloop/optimize/bundle/bundle_residuals.hpp"
#include "kinloop/optimize/pose/camera_observations.hpp"

namespace kinloop {
namespace {

// Outliers are found long before the last digits of the cost, whose decrease they slow down.
constexpr double kEarlyToleranceFactor = 10;
constexpr double kMinParallax_rad = 0.003;  // with less parallax two rays do not determine a point

void check(const BundleProblem& problem) {
  const size_t poses = problem.T_world_camera.size();
  require(problem.fixed.empty() || problem.fixed.size() == poses,
          "solve_bundle: expected one `fixed` flag per pose");
  require(problem.velocities.empty() || problem.velocities.size() == poses,
          "solve_bundle: expected one velocity per pose");
  for (const BundleObservation& o : problem.observations) {
    require(o.pose < poses && o.point < problem.p_world.size(),
            "solve_bundle: observation index out of range");
  }
}

/// Use of an observation if it is an inlier.
BundleUse initial_use(const BundleProblem& problem, const BundleObservation& o) {
  const bool finite = o.pixel.allFinite() && o.sigma_px > 0 && std::isfinite(o.row) &&
                      problem.p_world[o.point].allFinite() && problem.T_world_camera[o.pose].is_finite();
  if (!finite) return BundleUse::kNothing;
  return o.depth_m > 0 && std::isfinite(o.depth_m) ? BundleUse::kPixelAndDepth : BundleUse::kPixel;
}

/// Whether the observations of a point (all in use) determine its position, by a depth or by two rays with
/// parallax.
bool is_constrained(const BundleTask& task, const BundleState& state, const Eigen::Vector3d& p_world,
                    const std::vector<uint32_t>& observations) {
  if (observations.empty()) return false;
  const auto& all = task.problem.observations;
  const auto ray = [&](uint32_t i) -> Eigen::Vector3d {
    return (p_world - state.T_world_camera[all[i].pose].translation).normalized();
  };
  const Eigen::Vector3d first = ray(observations.front());
  for (const uint32_t i : observations) {
    if (task.uses[i] == BundleUse::kPixelAndDepth) return true;
    if (first.cross(ray(i)).norm() > kMinParallax_rad) return true;
  }
  return false;
}

/// Drops all observations of points that they do not constrain.
void drop_unconstrained_points(BundleTask& task, const BundleState& state) {
  std::vector<std::vector<uint32_t>> seen(state.p_world.size());
  for (uint32_t i = 0; i < task.uses.size(); ++i) {
    if (task.uses[i] != BundleUse::kNothing) seen[task.problem.observations[i].point].push_back(i);
  }
  for (size_t point = 0; point < seen.size(); ++point) {
    if (is_constrained(task, state, state.p_world[point], seen[point])) continue;
    for (const uint32_t i : seen[point]) task.uses[i] = BundleUse::kNothing;
  }
}

/// Use of an observation given its residuals.
BundleUse inlier_use(const NoiseModel& noise, const BundleBlock& block, const BlockResiduals& r,
                     size_t lane) {
  if (!r.is_pixel_inlier(lane, noise.inlier_chi2_pixel)) return BundleUse::kNothing;
  const bool has_depth = block.measured.inverse_depth_per_m[lane] > 0;
  return has_depth && r.is_depth_inlier(lane, noise.inlier_chi2_depth) ? BundleUse::kPixelAndDepth
                                                                       : BundleUse::kPixel;
}

/// Reclassifies the observations of adjusted points; those of other points keep their classification.
std::vector<uint8_t> classify(BundleTask& task, const BundleState& state, std::vector<uint8_t> outliers) {
  const auto views = views_of(task, state);
  const auto adjusted = used_points(task);
  const Sensor sensor = sensor_at(task, state);
  for (size_t pose = 0; pose < views.size(); ++pose) {
    for (const BundleBlock& block : task.blocks_of_pose[pose]) {
      const BlockResiduals r = block_residuals(block_at(task, block, state), views[pose], sensor);
      for (size_t lane = 0; lane < block.count; ++lane) {
        const uint32_t i = block.observations[lane];
        if (adjusted[task.problem.observations[i].point] == 0) continue;
        task.uses[i] = inlier_use(sensor.noise, block, r, lane);
        outliers[i] = task.uses[i] == BundleUse::kNothing;
      }
    }
  }
  drop_unconstrained_points(task, state);
  return outliers;
}

/// Returns the usable observations of each pose in the order of the problem.
std::vector<std::vector<BundleBlock>> make_blocks(const BundleTask& task) {
  std::vector<std::vector<BundleBlock>> blocks_of_pose(task.problem.T_world_camera.size());
  for (uint32_t i = 0; i < task.uses.size(); ++i) {
    if (task.uses[i] == BundleUse::kNothing) continue;
    auto& blocks = blocks_of_pose[task.problem.observations[i].pose];
    if (blocks.empty() || blocks.back().count == ObservationBlock::kSize) blocks.emplace_back();
    BundleBlock& block = blocks.back();
    set_measurement(block.measured, block.count, task.problem.observations[i]);
    block.points[block.count] = task.problem.observations[i].point;
    block.observations[block.count++] = i;
  }
  return blocks_of_pose;
}

BundleTask make_task(const BundleProblem& problem, const BundleOptions& options) {
  const size_t poses = problem.T_world_camera.size();
  BundleTask task{problem, options, problem.fixed, problem.velocities, {}, {}, problem.prior};
  task.fixed.resize(poses, 0);
  for (size_t i = 0; i < poses; ++i) {
    if (!problem.T_world_camera[i].is_finite()) task.fixed[i] = 1;
  }
  const bool held = std::any_of(task.fixed.begin(), task.fixed.end(), [](uint8_t f) { return f != 0; });
  if (!held && poses > 0) task.fixed[0] = 1;
  task.velocities.resize(poses);
  for (const BundleObservation& o : problem.observations) task.uses.push_back(initial_use(problem, o));
  task.blocks_of_pose = make_blocks(task);
  return task;
}

}  // namespace

BundleSolution solve_bundle(const BundleProblem& problem, const BundleOptions& options) {
  check(problem);
  BundleTask task = make_task(problem, options);
  const BundleState start{problem.T_world_camera, problem.p_world, problem.sensor.corrections};
  drop_unconstrained_points(task, start);

  BundleSolution solution;
  for (const BundleObservation& o : problem.observations) {
    solution.outliers.push_back(initial_use(problem, o) == BundleUse::kNothing);
  }
  BundleState state = start;
  const bool selects = problem.prior.selects_parameters();
  const int rounds = selects ? std::max(options.rounds, 2) : options.rounds;
  for (int round = 0; round < rounds; ++round) {
    task.tolerance = round + 1 == rounds ? options.tolerance : kEarlyToleranceFactor * options.tolerance;
    const BundleRoundResult result = options.solver == BundleSolver::kCeres ? minimize_with_ceres(task, state)
                                                                            : minimize_builtin(task, state);
    state = result.state;
    solution.iterations += result.iterations;
    solution.converged = result.converged;
    solution.outliers = classify(task, state, std::move(solution.outliers));
    if (round > 0 || !selects) continue;
    BundleSelection selection = select_sensor_parameters(task, state);
    solution.sensor_covariance = selection.covariance;
    task.prior = selection.prior;
    state = std::move(selection.state);
  }
  solution.chi2_before = bundle_cost(task, start);
  solution.chi2_after = bundle_cost(task, state);
  for (const int k : task.prior.free_parameters()) solution.sensor_free[static_cast<size_t>(k)] = true;
  const bool wants_sensor = !selects && !problem.prior.free_parameters().empty();
  if (options.pose_covariances || wants_sensor) {
    BundleCovariance covariance = bundle_covariance(task, state);
    if (wants_sensor) solution.sensor_covariance = covariance.sensor;
    solution.pose_covariance = std::move(covariance.poses);
    if (options.pose_covariances) {
      const ResidualStatistics residuals = residual_statistics(task, state);
      solution.residual_variance = residuals.variance;
      solution.residual_clustering = residuals.clustering;
    }
  }
  solution.point_used = used_points(task);
  solution.T_world_camera = std::move(state.T_world_camera);
  solution.p_world = std::move(state.p_world);
  solution.corrections = state.corrections;
  return solution;
}

}  // namespace kinloop
