#include "kinloop/loop/verification/verify_loop.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/features/keypoint_measurements.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/loop/recognition/recognize_place.hpp"
#include "kinloop/loop/verification/relative_scale.hpp"
#include "kinloop/optimize/pose/ransac/ransac.hpp"
#include "kinloop/place/match_by_nodes.hpp"

namespace kinloop {
namespace {

// Without landmarks of several views, a keypoint has one true match at most, so the ratio test of Lowe (2004)
// holds. It drops most chance matches, which RANSAC would pay for.
constexpr NodeMatchOptions kMatching{.max_distance = 64, .max_ratio = 0.8};

/// Whether an error of that size explains the angle between the predicted direction of a point and that of
/// its match.
bool is_displaced_within(const ErrorMagnitude& error, const Eigen::Vector3d& p_camera,
                         const Eigen::Vector3d& ray) {
  const double angle_rad = std::atan2(p_camera.cross(ray).norm(), p_camera.dot(ray));
  return angle_rad <= displaced_rad(error, p_camera);
}

std::vector<PoseObservation> matched_observations(const ViewPair& views, const PinholeCamera& camera) {
  const auto& [reference_view, camera_view, predicted] = views;
  const Features &reference = reference_view.features, &features = camera_view.features;
  const SE3 T_camera_reference = predicted ? predicted->T_reference_camera.inverse() : SE3{};
  const ErrorMagnitude error = predicted ? largest_error(predicted->covariance) : ErrorMagnitude{};
  std::vector<PoseObservation> observations;
  for (const Match& match : match_by_nodes({reference.descriptors, reference_view.nodes},
                                           {features.descriptors, camera_view.nodes}, kMatching)) {
    const auto depth_m = static_cast<double>(reference.depths_m[match.a]);
    if (!(depth_m > 0)) continue;
    const Eigen::Vector3d p_reference = camera.unproject(reference.pixels[match.a].cast<double>(), depth_m);
    const Eigen::Vector3d ray = camera.unproject(features.pixels[match.b].cast<double>(), 1);
    if (predicted && !is_displaced_within(error, T_camera_reference * p_reference, ray)) continue;
    observations.push_back({compensated_measurement(features, match.b), p_reference});
  }
  return observations;
}

/// A view beside one that has been verified overlaps less with the place, and its pose is known: half of the
/// inlier ratio is enough.
LoopOptions options_for(const LoopClosure& hypothesis, LoopOptions options) {
  if (hypothesis.support > 1) options.min_inlier_ratio /= 2;
  return options;
}

}  // namespace

std::optional<SE3> propose_pose(const ViewPair& views, const PlaceContext& context, uint64_t seed) {
  const PnpRansacOptions& options = context.options.tracking.pnp;
  const auto observations = matched_observations(views, context.sensor.camera);
  if (static_cast<int>(observations.size()) < options.min_inliers) return std::nullopt;
  // A pose with fewer inliers than required is of no use, so RANSAC need not sample long enough to find it.
  constexpr uint32_t kSampleSize = 3;
  PnpRansacOptions limited = options;
  limited.max_iterations = static_cast<int>(std::min<double>(
      options.max_iterations, std::ceil(required_samples(options.min_inliers, observations.size(),
                                                         kSampleSize, options.confidence))));
  limited.max_iterations = std::max(limited.max_iterations, 1);
  const auto solution =
      solve_pnp_ransac(context.sensor, observations, limited, context.options.tracking.pose, seed);
  if (!solution) return std::nullopt;
  return solution->T_reference_camera;
}

LoopVerificationProblem make_loop_verification_problem(const Keyframe& keyframe) {
  LoopVerificationProblem problem;
  problem.frame.id = keyframe.frame;
  problem.frame.stamp_ns = keyframe.stamp_ns;
  problem.frame.features = keyframe.features;
  return problem;
}

std::vector<LoopVerificationResult> verify_loops(const LoopVerificationProblem& problem,
                                                 const PlaceContext& context) {
  std::vector<LoopVerificationResult> verified;
  for (const auto& [hypothesis, predicted, local_map] : problem.candidates) {
    const TrackingInput in{problem.frame, local_map, context.sensor, context.options.tracking};
    auto found = confirm_pose(in, hypothesis.T_a_b, options_for(hypothesis, context.options.loop));
    if (!found) continue;
    if (predicted && !is_explained(*predicted, found->T_reference_camera)) continue;
    const LoopClosure loop{.a = hypothesis.a,
                           .b = hypothesis.b,
                           .T_a_b = found->T_reference_camera,
                           .information = edge_information(found->evidence.inliers, context.options.loop),
                           .evidence = {found->evidence.inliers, found->evidence.visible_landmarks,
                                        measure_scale(in, found->T_reference_camera)},
                           .stage = LoopStage::kVerified};
    verified.push_back({loop, std::move(found->matches)});
  }
  return verified;
}

LandmarkMerges landmark_merges(const Map& map, const LoopVerificationResult& verified) {
  LandmarkMerges merges;
  const auto& landmark_of = map.keyframe(verified.loop.b).landmark_of;
  for (const LandmarkMatch& match : verified.matches) {
    const LandmarkId newer = landmark_of[match.feature];
    const LandmarkId matched = map.resolve_merged(match.landmark);  // it may have waited for other keyframes
    if (newer.valid() && newer != matched && map.contains(matched)) merges.emplace_back(newer, matched);
  }
  return merges;
}

}  // namespace kinloop
