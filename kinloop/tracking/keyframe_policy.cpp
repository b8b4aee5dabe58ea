#include "kinloop/tracking/keyframe_policy.hpp"

#include <algorithm>
#include <limits>

#include "kinloop/core/quantile.hpp"
#include "kinloop/tracking/keypoint_tracking.hpp"

namespace kinloop {
namespace {

double median_depth_m(const Features& features) {
  std::vector<float> depths;
  for (const float depth : features.depths_m) {
    if (depth > 0) depths.push_back(depth);
  }
  return depths.empty() ? 1.0 : median(std::move(depths));
}

int unmapped_with_depth(const TrackedFrame& tracked) {
  const Features& features = tracked.features();
  std::vector<bool> mapped(features.size(), false);
  for (const auto& match : tracked.matches) mapped[match.feature] = true;
  int count = 0;
  for (size_t i = 0; i < features.size(); ++i) count += features.depths_m[i] > 0 && !mapped[i] ? 1 : 0;
  return count;
}

/// Camera motion relative to the motion that triggers a keyframe.
double relative_motion(const SE3& T_keyframe_camera, double depth_m, const KeyframeOptions& options) {
  return std::max(T_keyframe_camera.angle_rad() / options.max_rotation_rad,
                  T_keyframe_camera.translation.norm() / (depth_m * options.max_relative_translation));
}

/// Returns how many of the matched landmarks each keyframe observes.
std::vector<int> shared_counts(const Map& map, const std::vector<LandmarkMatch>& matches) {
  std::vector<int> shared(map.keyframes().size(), 0);
  for (const LandmarkMatch& match : matches) {
    if (!map.contains(match.landmark)) continue;
    for (const auto& observation : map.landmark(match.landmark).observations)
      ++shared[observation.keyframe.value];
  }
  return shared;
}

/// Returns the number of a keyframe's landmarks that at least one other keyframe observes.
int count_confirmed_landmarks(const Map& map, KeyframeId id) {
  int count = 0;
  for (const LandmarkId landmark : map.keyframe(id).landmark_of) {
    count += landmark.valid() && map.landmark(landmark).observations.size() >= 2 ? 1 : 0;
  }
  return count;
}

KeyframeCriteria criteria_of(const TrackedFrame& tracked, const Map& map) {
  return {tracked, motions_from_keyframes(map, tracked),
          static_cast<int>(tracked.id.value - map.keyframes().back().frame.value),
          count_confirmed_landmarks(map, tracked.reference)};
}

/// Below this motion from the nearest keyframe no frame becomes one: a static camera sees nothing new,
/// however long it stays.
constexpr double kMinKeyframeMotion = 0.5;

}  // namespace

bool may_extend_map(const TrackedFrame& tracked) {
  if (tracked.is_lost() || tracked.is_repeat()) return false;
  if (tracked.is_doubtful() && !is_weak_evidence(tracked.trust.cause)) return false;
  if (tracked.outcome == TrackingOutcome::kNewMap) return true;
  const bool is_weak = tracked.is_doubtful() || !tracked.is_tracked_by_landmarks();
  return !is_weak || !misses_landmarks(tracked, tracked.features());
}

KeyframeOptions spaced_for_direct_tracking(KeyframeOptions options) {
  constexpr double kSpacing = 1.5;
  options.max_relative_translation *= kSpacing;
  return options;
}

double motion_from_nearest(const Features& features, std::span<const SE3> T_keyframe_camera,
                           const KeyframeOptions& options) {
  const double depth_m = median_depth_m(features);
  double nearest = std::numeric_limits<double>::infinity();
  for (const SE3& T : T_keyframe_camera) nearest = std::min(nearest, relative_motion(T, depth_m, options));
  return nearest;
}

bool needs_keyframe(const KeyframeCriteria& q, const KeyframeOptions& options) {
  const TrackedFrame& tracked = q.tracked;
  if (!tracked.is_located()) return false;
  if (!tracked.is_tracked_by_landmarks() && unmapped_with_depth(tracked) <= options.min_unmapped_keypoints)
    return false;
  const double moved = motion_from_nearest(tracked.features(), q.T_keyframe_camera, options);
  if (moved > 1) return true;
  if (moved < kMinKeyframeMotion) return false;

  const int inliers = tracked.evidence.inliers;
  const bool overlap_too_low = inliers < options.min_tracked_ratio * q.reference_landmarks;
  const bool too_few_landmarks =
      inliers < options.min_landmarks && unmapped_with_depth(tracked) > options.min_unmapped_keypoints;
  return overlap_too_low || too_few_landmarks || q.frames_since_keyframe >= options.max_interval_frames;
}

std::vector<SE3> motions_from_keyframes(const Map& map, const TrackedFrame& tracked) {
  constexpr double kMinSharedFraction = 0.3;
  const Keyframe &reference = map.keyframe(tracked.reference), &newest = map.keyframes().back();
  const SE3 T_world_camera = reference.T_world_camera * tracked.T_reference_camera;
  std::vector<SE3> motions;
  if (newest.component == reference.component)
    motions.push_back(newest.T_world_camera.inverse() * T_world_camera);
  const std::vector<int> shared = shared_counts(map, tracked.matches);
  for (const Keyframe& keyframe : map.keyframes()) {
    const int both = shared[keyframe.id.value];
    if (both == 0 || both < kMinSharedFraction * static_cast<double>(tracked.matches.size())) continue;
    motions.push_back(keyframe.T_world_camera.inverse() * T_world_camera);
  }
  return motions;
}

std::optional<TrackedFrame> KeyframeSelector::select(const TrackedFrame& tracked, const Map& map,
                                                     const Rematch& rematch) {
  if (!may_extend_map(tracked)) return std::nullopt;
  if (tracked.outcome == TrackingOutcome::kNewMap) return tracked;
  if (tracked.features().has_descriptors()) {
    return needs_keyframe(criteria_of(tracked, map), options_) ? std::optional(tracked) : std::nullopt;
  }
  const KeyframeOptions spaced = spaced_for_direct_tracking(options_);
  const double moved = motion_from_nearest(tracked.features(), motions_from_keyframes(map, tracked), spaced);
  if (!is_worth_rematching(tracked, moved)) return std::nullopt;
  last_rematched_ns_ = tracked.stamp_ns;
  TrackedFrame rematched = rematch(tracked);
  if (rematched.is_lost() || !needs_keyframe(criteria_of(rematched, map), spaced)) return std::nullopt;
  return rematched;
}

bool KeyframeSelector::is_worth_rematching(const TrackedFrame& tracked, double moved) const {
  constexpr int64_t kMinInterval_ns = 120'000'000;  // extraction costs more than direct tracking
  if (moved < kMinKeyframeMotion) return false;
  return moved > 1 || !last_rematched_ns_ || tracked.stamp_ns - *last_rematched_ns_ >= kMinInterval_ns;
}

KeyframeId best_reference(const Map& map, const std::vector<LandmarkMatch>& matches, KeyframeId fallback) {
  const std::vector<int> shared = shared_counts(map, matches);
  const auto most = std::max_element(shared.begin(), shared.end());
  if (most == shared.end() || *most == 0) return fallback;
  return KeyframeId{static_cast<uint32_t>(most - shared.begin())};
}

}  // namespace kinloop
