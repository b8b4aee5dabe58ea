#include "kinloop/loop/propose_loop.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/features/keypoint_measurements.hpp"
#include "kinloop/optimize/pose/ransac.hpp"
#include "kinloop/place/match_by_nodes.hpp"

namespace kinloop {
namespace {

// Without landmarks of several views, a keypoint has one true match at most, so the ratio test of Lowe (2004)
// holds. It drops most chance matches, which RANSAC would pay for.
constexpr NodeMatchOptions kMatching{.max_distance = 64, .max_ratio = 0.8};

/// Whether drift explains the angle between the predicted direction of a point and that of its match.
bool agrees_with_prediction(const PredictedView& predicted, const Eigen::Vector3d& p_reference,
                            const Eigen::Vector3d& ray) {
  const Eigen::Vector3d p_camera = predicted.T_reference_camera.inverse() * p_reference;
  const double angle_rad = std::atan2(p_camera.cross(ray).norm(), p_camera.dot(ray));
  return angle_rad <= direction_bound_rad(predicted.bound, p_camera);
}

std::vector<PoseObservation> matched_observations(const ViewPair& views, const PinholeCamera& camera) {
  const auto& [reference_view, camera_view, predicted] = views;
  const Features &reference = reference_view.features, &features = camera_view.features;
  std::vector<PoseObservation> observations;
  for (const Match& match : match_by_nodes({reference.descriptors, reference_view.nodes},
                                           {features.descriptors, camera_view.nodes}, kMatching)) {
    const auto depth_m = static_cast<double>(reference.depths_m[match.a]);
    if (!(depth_m > 0)) continue;
    const Eigen::Vector3d p_reference = camera.unproject(reference.pixels[match.a].cast<double>(), depth_m);
    const Eigen::Vector3d ray = camera.unproject(features.pixels[match.b].cast<double>(), 1);
    if (predicted && !agrees_with_prediction(*predicted, p_reference, ray)) continue;
    observations.push_back({compensated_measurement(features, match.b), p_reference});
  }
  return observations;
}

}  // namespace

std::optional<SE3> propose_pose(const ViewPair& views, const Sensor& sensor, const TrackingOptions& options,
                                uint64_t seed) {
  const auto observations = matched_observations(views, sensor.camera);
  PnpRansacOptions limited = options.pnp;
  if (static_cast<int>(observations.size()) < limited.min_inliers) return std::nullopt;
  // A pose with fewer inliers than required is of no use, so RANSAC need not sample long enough to find it.
  constexpr uint32_t kSampleSize = 3;
  limited.max_iterations = static_cast<int>(std::min<double>(
      limited.max_iterations, std::ceil(required_samples(limited.min_inliers, observations.size(),
                                                         kSampleSize, limited.confidence))));
  limited.max_iterations = std::max(limited.max_iterations, 1);
  const auto solution = solve_pnp_ransac(sensor, observations, limited, options.pose, seed);
  if (!solution) return std::nullopt;
  return solution->T_reference_camera;
}

}  // namespace kinloop
