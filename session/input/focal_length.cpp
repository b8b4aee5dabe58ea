#include "session/input/focal_length.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "kinloop/back_end/self_calibration.hpp"

namespace kinloop {
namespace {

constexpr uint32_t kKeyframes = 12;
constexpr size_t kMostPoints = 800;
constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

/// The first of the successive keyframes that have the most observations.
uint32_t first_of_window(const BundleProblem& problem) {
  const auto poses = static_cast<uint32_t>(problem.T_world_camera.size());
  std::vector<size_t> observations(poses);
  for (const BundleObservation& seen : problem.observations) ++observations[seen.pose];
  uint32_t best = 0;
  size_t most = 0;
  for (uint32_t first = 0; first + kKeyframes <= poses; ++first) {
    size_t sum = 0;
    for (uint32_t i = first; i < first + kKeyframes; ++i) sum += observations[i];
    if (sum > most) most = sum, best = first;
  }
  return best;
}

/// The new index of each point: those that the window sees most often come first, the others get none.
std::vector<uint32_t> selected_points(const BundleProblem& problem, uint32_t first) {
  constexpr int kFewestViews = 3;
  std::vector<int> views(problem.p_world.size());
  for (const BundleObservation& seen : problem.observations)
    views[seen.point] += seen.pose >= first && seen.pose < first + kKeyframes ? 1 : 0;
  std::vector<uint32_t> points;
  for (uint32_t i = 0; i < views.size(); ++i) {
    if (views[i] >= kFewestViews) points.push_back(i);
  }
  std::stable_sort(points.begin(), points.end(), [&](uint32_t a, uint32_t b) { return views[a] > views[b]; });
  points.resize(std::min(points.size(), kMostPoints));
  std::vector<uint32_t> index(views.size(), kNone);
  for (uint32_t i = 0; i < points.size(); ++i) index[points[i]] = i;
  return index;
}

/// The part of the problem that the window sees.
BundleProblem window_of(const BundleProblem& whole) {
  const uint32_t first = first_of_window(whole);
  const uint32_t end =
      std::min<uint32_t>(first + kKeyframes, static_cast<uint32_t>(whole.T_world_camera.size()));
  const std::vector<uint32_t> index = selected_points(whole, first);
  BundleProblem part;
  part.sensor = whole.sensor;
  for (uint32_t i = first; i < end; ++i) {
    part.T_world_camera.push_back(whole.T_world_camera[i]);
    part.velocities.push_back(whole.velocities[i]);
  }
  for (uint32_t i = 0; i < index.size(); ++i) {
    if (index[i] == kNone) continue;
    if (part.p_world.size() <= index[i]) part.p_world.resize(index[i] + 1);
    part.p_world[index[i]] = whole.p_world[i];
  }
  for (BundleObservation seen : whole.observations) {
    if (seen.pose < first || seen.pose >= end || index[seen.point] == kNone) continue;
    seen.pose -= first;
    seen.point = index[seen.point];
    part.observations.push_back(seen);
  }
  return part;
}

/// The sensor of camera.yaml with the estimated times.
Sensor with_nominal_lens(const SensorEstimate& estimate) {
  Sensor sensor = estimate.sensor;
  sensor.corrections = estimate.nominal;
  for (const int k : {kRollingShutter, kDepthDelay, kDepthShutter})
    sensor.corrections(k) = estimate.sensor.corrections(k);
  return sensor;
}

}  // namespace

bool FocalLengthEstimate::contradicts_camera() const {
  constexpr double kMinError = 0.04, kMaxDifference = 0.04, kMaxSigma = 0.02, kSigmas = 4;
  const auto off = [&](double factor, double sigma) {
    return sigma < kMaxSigma && std::abs(factor - 1) > std::max(kMinError, kSigmas * sigma);
  };
  return off(factor_x, sigma_x) && off(factor_y, sigma_y) && std::abs(factor_x - factor_y) < kMaxDifference;
}

std::optional<FocalLengthEstimate> estimate_focal_length(const Map& map, const SensorEstimate& sensor,
                                                         std::vector<Velocity> velocities) {
  constexpr size_t kFewestKeyframes = 4, kFewestPoints = 100;
  constexpr double kWidePrior = 0.2;
  constexpr int kRounds = 1, kIterations = 6;
  if (map.keyframes().size() < kFewestKeyframes) return std::nullopt;
  const Sensor nominal = with_nominal_lens(sensor);
  BundleProblem problem =
      window_of(make_self_calibration_problem(map, nominal, std::move(velocities)).bundle);
  if (problem.p_world.size() < kFewestPoints) return std::nullopt;
  problem.prior.mean = nominal.corrections;
  problem.prior.sigma(kFocalX) = kWidePrior * nominal.camera.fx;
  problem.prior.sigma(kFocalY) = kWidePrior * nominal.camera.fy;
  BundleOptions options;
  options.rounds = kRounds;
  options.max_iterations = kIterations;
  const BundleSolution solution = solve_bundle(problem, options);
  const auto sigma = [&](int k) { return std::sqrt(std::max(solution.sensor_covariance(k, k), 0.0)); };
  return FocalLengthEstimate{1 + solution.corrections(kFocalX) / nominal.camera.fx,
                             1 + solution.corrections(kFocalY) / nominal.camera.fy,
                             sigma(kFocalX) / nominal.camera.fx, sigma(kFocalY) / nominal.camera.fy};
}

}  // namespace kinloop
