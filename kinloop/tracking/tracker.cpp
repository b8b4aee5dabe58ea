#include "kinloop/tracking/tracker.hpp"

#include <algorithm>

#include "kinloop/tracking/previous_frame.hpp"

namespace kinloop {
namespace {

/// Landmarks of the view that the camera should see, with the index of each in the view.
struct VisibleLandmarks {
  std::vector<ProjectedPoint> projected;
  std::vector<uint32_t> index_in_view;
};

VisibleLandmarks project_view(const LocalView& view, const Features& features, const SE3& T_reference_camera,
                              double window_px, const PinholeCamera& camera) {
  VisibleLandmarks visible;
  for (uint32_t i = 0; i < view.size(); ++i) {
    const auto expected = project_landmark(view, i, features, T_reference_camera, window_px, camera);
    if (!expected) continue;
    visible.projected.push_back(*expected);
    visible.index_in_view.push_back(i);
  }
  return visible;
}

/// Refines on landmarks of the view, and where they are few also on the previous frame's unmapped points;
/// `prior` is what depth and grey images say.
TrackResult refine(const PreparedFrame& frame, const FeatureGrid& grid, const LocalView& view,
                   const FramePose& guess, const std::optional<PosePrior>& prior, double window_px,
                   const PinholeCamera& camera, const TrackingOptions& options) {
  const Features& features = *frame.features;
  const auto visible = project_view(view, features, guess.T_reference_camera, window_px, camera);
  const auto matches = match_by_projection(visible.projected, features, grid, {});
  std::vector<PoseObservation> observations;
  std::vector<bool> taken(features.size(), false);
  for (const Match& match : matches) {
    taken[match.b] = true;
    observations.push_back(
        {view.p_reference[visible.index_in_view[match.a]], features.pixels[match.b].cast<double>(),
         static_cast<double>(features.depths_m[match.b]), static_cast<double>(features.sigmas_px[match.b])});
  }
  if (static_cast<int>(matches.size()) < options.enough_landmarks) {
    for (size_t i = 0; i < guess.support.size(); ++i) {
      if (!taken[guess.features[i]]) observations.push_back(guess.support[i]);
    }
  }
  TrackResult result;
  result.reference = view.reference;
  result.stats.in_view = static_cast<int>(visible.projected.size());
  const auto solution =
      solve_absolute_pose(camera, observations, guess.T_reference_camera, options.pose, prior);
  if (!solution || solution->inlier_count < options.min_inliers) return result;
  result.status = TrackStatus::kTracked;
  result.T_reference_camera = solution->T_reference_camera;
  result.information = solution->information;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (solution->inliers[i])
      result.matches.push_back({view.ids[visible.index_in_view[matches[i].a]], matches[i].b});
  }
  result.stats.inliers = static_cast<int>(result.matches.size());
  return result;
}

}  // namespace

bool map_agrees(const TrackResult& result, const Features& features, double min_found_share) {
  const int findable = std::min(result.stats.in_view, static_cast<int>(features.size()));
  return result.stats.inliers >= min_found_share * findable;
}

TrackResult track_in_view(const PreparedFrame& frame, const FeatureGrid& grid, const LocalView& view,
                          const SE3& T_reference_camera_guess, double window_px, const PinholeCamera& camera,
                          const TrackingOptions& options) {
  FramePose guess;
  guess.T_reference_camera = T_reference_camera_guess;
  return refine(frame, grid, view, guess, std::nullopt, window_px, camera, options);
}

TrackResult track(const PreparedFrame& frame, const TrackedFrame& previous, const LocalView& view,
                  const PredictedPose& predicted, const PinholeCamera& camera, const TrackingOptions& options,
                  uint64_t seed) {
  const FeatureGrid grid(*frame.features, camera.width, camera.height);
  const auto guess = pose_from_previous(frame, grid, previous, view, predicted, camera, options, seed);
  if (!guess) {
    // The previous frame may have been blurred beyond use; the map still knows what should be in sight.
    const TrackResult result =
        track_in_view(frame, grid, view, predicted.T, options.wide_window_px, camera, options);
    return map_agrees(result, *frame.features, options.min_found_share) ? result : TrackResult{};
  }
  std::optional<PosePrior> prior;
  if (options.refine_with_icp && !guess->dense) {
    const auto dense = align_with_previous(frame, previous, guess->T_reference_camera, camera, options);
    if (dense) prior = PosePrior{dense->T_reference_camera, dense->information};
  }
  TrackResult result = refine(frame, grid, view, *guess, prior, options.view_window_px, camera, options);
  if (guess->by_force && !map_agrees(result, *frame.features, options.min_found_share)) return {};
  if (result.status == TrackStatus::kLost) {
    result.T_reference_camera = guess->T_reference_camera;
    result.information = guess->information;
    result.status = guess->dense ? TrackStatus::kDenseOnly : TrackStatus::kTracked;
  }
  result.stats.from_previous = static_cast<int>(guess->support.size());
  result.stats.tries = guess->tries;
  return result;
}

}  // namespace kinloop
