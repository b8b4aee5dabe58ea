#include "kinloop/loop/recognition/recognize_place.hpp"

#include "kinloop/features/keypoint_measurements.hpp"
#include "kinloop/loop/verification/view_checks.hpp"
#include "kinloop/tracking/evidence/surface_evidence.hpp"

namespace kinloop {
namespace {

/// Pairs (landmark of the local map, keypoint) that are mutual nearest neighbours by descriptor.
std::vector<Match> match_descriptors(const Features& features, const LocalMap& local_map,
                                     const LoopOptions& options) {
  std::vector<Match> kept;
  for (const Match& match : match_brute_force(local_map.descriptors, features.descriptors, true)) {
    if (match.distance <= options.max_hamming_distance) kept.push_back(match);
  }
  return kept;
}

bool is_verified(const TrackedFrame& result, const TrackingInput& in, const LoopOptions& options) {
  const Features &features = *in.frame.features, &reference = *in.local_map.features;
  if (result.is_lost() || result.evidence.inliers < options.min_inliers) return false;
  if (!has_sufficient_inlier_ratio(result, features, options.min_inlier_ratio)) return false;
  const SE3& T_reference_camera = result.T_reference_camera;
  const SurfaceAgreement surfaces = agreement_with_reference(in.local_map, in.frame, T_reference_camera);
  if (contradicts_unexpected_pose(surfaces, result, in.frame)) return false;
  const auto depths =
      compare_depths({reference}, {features}, T_reference_camera, in.sensor, options.landmark_sigma_m);
  return !contradicts_free_space(depths, options.max_free_space_violation_ratio) &&
         appearance_p_value({reference}, {features}, T_reference_camera, in.sensor.camera) >=
             options.min_p_value;
}

}  // namespace

std::optional<TrackedFrame> recognize_place(const TrackingInput& in, const LoopOptions& options,
                                            uint64_t seed) {
  const Features& features = *in.frame.features;
  const auto matches = match_descriptors(features, in.local_map, options);
  if (static_cast<int>(matches.size()) < options.min_matches) return std::nullopt;
  std::vector<PoseObservation> observations;
  for (const Match& match : matches) {
    observations.push_back({compensated_measurement(features, match.b), in.local_map.p_reference[match.a]});
  }
  const auto initial = solve_pnp_ransac(in.sensor, observations, in.options.pnp, in.options.pose, seed);
  if (!initial) return std::nullopt;
  return confirm_pose(in, initial->T_reference_camera, options);
}

std::optional<TrackedFrame> confirm_pose(const TrackingInput& in, const SE3& T_reference_camera,
                                         const LoopOptions& options) {
  TrackedFrame result = track_local_map(in, T_reference_camera, options.window_px);
  if (result.is_lost()) return std::nullopt;
  // Match again from the improved pose, which centres the search windows correctly.
  result = track_local_map(in, result.T_reference_camera, in.options.local_map_window_px);
  if (!is_verified(result, in, options)) return std::nullopt;
  return result;
}

}  // namespace kinloop
