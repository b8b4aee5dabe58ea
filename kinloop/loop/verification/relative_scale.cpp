#include "kinloop/loop/verification/relative_scale.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/core/quantile.hpp"

namespace kinloop {
namespace {

constexpr int kIterations = 10;
constexpr double kHuberWidth = 1.345;      // sigmas: 95 % efficiency for Gaussian errors (Huber 1981)
constexpr double kScaleWindow_px = 8;      // half side, on level 0
constexpr double kLandmarkSigma_m = 0.01;  // of landmarks in the map
constexpr double kCommonSigma = 0.002;     // an error that all matches of a view share, relative

/// Weighted least squares for scale and translation with the means eliminated.
struct ScaleFit {
  double scale = 1;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double information = 0;  ///< of the scale, for unit variance of weight
};

ScaleFit fit(std::span<const ScalePair> pairs, const std::vector<Eigen::Vector3d>& turned,
             const std::vector<double>& weights) {
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero(), mean_b = mean_a;
  double sum = 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    mean_a += weights[i] * pairs[i].a, mean_b += weights[i] * turned[i];
    sum += weights[i];
  }
  mean_a /= sum, mean_b /= sum;
  double ab = 0, bb = 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    ab += weights[i] * (pairs[i].a - mean_a).dot(turned[i] - mean_b);
    bb += weights[i] * (turned[i] - mean_b).squaredNorm();
  }
  const double scale = ab / bb;
  return {scale, mean_a - scale * mean_b, bb};
}

}  // namespace

RelativeScale estimate_scale(std::span<const ScalePair> pairs, const Eigen::Matrix3d& R_a_b) {
  if (pairs.size() < kMinScalePairs) return {};
  std::vector<Eigen::Vector3d> turned;
  std::vector<double> weights;
  for (const ScalePair& pair : pairs) {
    turned.emplace_back(R_a_b * pair.b);
    weights.push_back(1 / (pair.sigma_m * pair.sigma_m));
  }
  ScaleFit found = fit(pairs, turned, weights);
  double sigma = 1;  // of the residuals, in units of `sigma_m`
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    std::vector<double> errors;
    for (size_t i = 0; i < pairs.size(); ++i)
      errors.push_back((pairs[i].a - found.scale * turned[i] - found.translation).norm() / pairs[i].sigma_m);
    // The norm of three Gaussian errors has a median of 1.538 sigma.
    constexpr double kMedianOfNorm = 1.538;
    sigma = std::max(quantile(errors, 0.5) / kMedianOfNorm, 1e-6);
    for (size_t i = 0; i < pairs.size(); ++i) {
      const double excess = errors[i] / (kHuberWidth * std::sqrt(3.0) * sigma);
      weights[i] = (excess > 1 ? 1 / excess : 1) / (pairs[i].sigma_m * pairs[i].sigma_m);
    }
    found = fit(pairs, turned, weights);
  }
  if (!(found.information > 0) || !std::isfinite(found.scale)) return {};
  return {found.scale, std::hypot(sigma / std::sqrt(found.information), kCommonSigma)};
}

RelativeScale measure_scale(const TrackingInput& in, const SE3& T_reference_camera) {
  const auto& [frame, local_map, sensor, options, grid] = in;
  const Features& features = *frame.features;
  std::vector<ProjectedPoint> projected;
  std::vector<uint32_t> landmark_of;
  const LandmarkProjector project{local_map, features, sensor.camera, T_reference_camera, kScaleWindow_px};
  for (uint32_t i = 0; i < local_map.size(); ++i) {
    const bool measured = local_map.has_depth.empty() || local_map.has_depth[i];
    const auto expected = measured ? project(i) : std::nullopt;
    if (!expected) continue;
    projected.push_back(*expected);
    landmark_of.push_back(i);
  }
  constexpr double kAnyDepth = 0.5;  // of the expected depth, either way
  std::vector<ScalePair> pairs;
  for (const Match& match : match_by_projection(projected, features, grid, {.max_depth_error = kAnyDepth})) {
    const auto depth_m = static_cast<double>(features.depths_m[match.b]);
    if (!(depth_m > 0)) continue;
    const Eigen::Vector3d p_camera =
        sensor.camera.unproject(features.pixels[match.b].cast<double>(), depth_m);
    const double depth_sigma_m = sensor.noise.plane.inverse_sigma_per_m(1 / depth_m) * depth_m * depth_m;
    pairs.push_back(
        {local_map.p_reference[landmark_of[match.a]], p_camera, std::hypot(kLandmarkSigma_m, depth_sigma_m)});
  }
  return estimate_scale(pairs, T_reference_camera.R());
}

RelativeScale combine(std::span<const RelativeScale> scales) {
  double weights = 0, sum = 0;
  for (const auto& [factor, sigma] : scales) {
    const double weight = 1 / (sigma * sigma);
    weights += weight;
    sum += weight * factor;
  }
  if (!(weights > 0)) return {};
  return {sum / weights, 1 / std::sqrt(weights)};
}

bool contradicts_equal_size(const RelativeScale& scale, double max_difference) {
  constexpr double kSigmas = 3;
  return std::abs(scale.factor - 1) > std::max(max_difference, kSigmas * scale.sigma);
}

bool contradicts_same_place(const RelativeScale& scale) {
  constexpr double kMaxDifference = 0.02;
  return contradicts_equal_size(scale, kMaxDifference);
}

}  // namespace kinloop
