#include "kinloop/loop/recognize.hpp"

#include "kinloop/loop/depth_check.hpp"
#include "kinloop/loop/picture_check.hpp"

namespace kinloop {
namespace {

/// Pairs (landmark of the view, key point) that are each other's nearest by descriptor.
std::vector<Match> match_descriptors(const Features& features, const LocalView& view,
                                     const LoopOptions& options) {
  std::vector<Match> kept;
  for (const Match& match : match_brute_force(view.descriptors, features.descriptors, true)) {
    if (match.distance <= options.max_distance) kept.push_back(match);
  }
  return kept;
}

bool certain(const TrackResult& result, const Features& features, const LocalView& view,
             const PinholeCamera& camera, const LoopOptions& options) {
  if (result.status != TrackStatus::kTracked || result.stats.inliers < options.min_inliers) return false;
  if (!map_agrees(result, features, options.min_found_share)) return false;
  const SE3& T_reference_camera = result.T_reference_camera;
  const auto depths =
      compare_depths(*view.features, features, T_reference_camera, camera, options.landmark_sigma_m);
  return !contradicts(depths, options.max_seen_through) &&
         chance_of_difference(*view.features, features, T_reference_camera, camera) >= options.min_chance;
}

}  // namespace

std::optional<TrackResult> recognize_place(const PreparedFrame& frame, const LocalView& view,
                                           const PinholeCamera& camera, const LoopOptions& options,
                                           const TrackingOptions& tracking, uint64_t seed) {
  const Features& features = *frame.features;
  const auto matches = match_descriptors(features, view, options);
  if (static_cast<int>(matches.size()) < options.min_matches) return std::nullopt;
  std::vector<PoseObservation> observations;
  for (const Match& match : matches) {
    observations.push_back({view.p_reference[match.a], features.pixels[match.b].cast<double>(),
                            static_cast<double>(features.depths_m[match.b]),
                            static_cast<double>(features.sigmas_px[match.b])});
  }
  const auto rough = solve_pnp_ransac(camera, observations, tracking.pnp, seed);
  if (!rough) return std::nullopt;

  const FeatureGrid grid(features, camera.width, camera.height);
  TrackResult result =
      track_in_view(frame, grid, view, rough->T_reference_camera, options.window_px, camera, tracking);
  if (result.status != TrackStatus::kTracked) return std::nullopt;
  // Once more from the better pose: the windows now fall where they belong.
  result =
      track_in_view(frame, grid, view, result.T_reference_camera, tracking.view_window_px, camera, tracking);
  if (!certain(result, features, view, camera, options)) return std::nullopt;
  return result;
}

}  // namespace kinloop
