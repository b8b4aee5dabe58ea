#include "kinloop/loop/recognize_place.hpp"

#include "kinloop/features/keypoint_measurements.hpp"
#include "kinloop/loop/view_checks.hpp"

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

bool is_verified(const TrackedFrame& result, const Features& features, const LocalMap& local_map,
                 const PlaceContext& context) {
  const LoopOptions& options = context.options.loop;
  if (result.is_lost() || result.evidence.inliers < options.min_inliers) return false;
  if (!has_sufficient_inlier_ratio(result, features, options.min_inlier_ratio)) return false;
  const SE3& T_reference_camera = result.T_reference_camera;
  const auto depths = compare_depths(*local_map.features, features, T_reference_camera, context.camera,
                                     {options.depth_noise, options.landmark_sigma_m});
  return !violates_free_space(depths, options.max_free_space_violation_ratio) &&
         appearance_p_value(*local_map.features, features, T_reference_camera, context.camera) >=
             options.min_p_value;
}

}  // namespace

std::optional<TrackedFrame> recognize_place(const Frame& frame, const LocalMap& local_map,
                                            const PlaceContext& context, uint64_t seed) {
  const Features& features = *frame.features;
  const auto matches = match_descriptors(features, local_map, context.options.loop);
  if (static_cast<int>(matches.size()) < context.options.loop.min_matches) return std::nullopt;
  std::vector<PoseObservation> observations;
  for (const Match& match : matches) {
    observations.push_back({compensated_measurement(features, match.b), local_map.p_reference[match.a]});
  }
  const auto initial = solve_pnp_ransac(context.camera, observations, context.options.tracking.pnp, seed);
  if (!initial) return std::nullopt;
  return confirm_pose(frame, local_map, initial->T_reference_camera, context);
}

std::optional<TrackedFrame> confirm_pose(const Frame& frame, const LocalMap& local_map,
                                         const SE3& T_reference_camera, const PlaceContext& context) {
  const Features& features = *frame.features;
  const TrackingOptions& tracking = context.options.tracking;
  const FeatureGrid grid(features, context.camera.width, context.camera.height);
  const TrackingTarget target{local_map, context.camera, tracking};
  TrackedFrame result =
      track_local_map(frame, grid, T_reference_camera, context.options.loop.window_px, target);
  if (result.is_lost()) return std::nullopt;
  // Match again from the improved pose, which centres the search windows correctly.
  result = track_local_map(frame, grid, result.T_reference_camera, tracking.local_map_window_px, target);
  if (!is_verified(result, features, local_map, context)) return std::nullopt;
  return result;
}

}  // namespace kinloop
