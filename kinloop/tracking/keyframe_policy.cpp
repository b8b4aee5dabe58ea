#include "kinloop/tracking/keyframe_policy.hpp"

#include <algorithm>

namespace kinloop {
namespace {

double median_depth_m(const Features& features) {
  std::vector<float> depths;
  for (const float depth : features.depths_m) {
    if (depth > 0) depths.push_back(depth);
  }
  if (depths.empty()) return 1.0;
  const auto middle = depths.begin() + static_cast<long>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

int unmapped_with_depth(const TrackResult& result, const Features& features) {
  std::vector<bool> mapped(features.size(), false);
  for (const auto& match : result.matches) mapped[match.feature] = true;
  int count = 0;
  for (size_t i = 0; i < features.size(); ++i) count += features.depths_m[i] > 0 && !mapped[i] ? 1 : 0;
  return count;
}

}  // namespace

bool needs_keyframe(const KeyframeQuestion& q, const KeyframeOptions& options) {
  if (q.result.status != TrackStatus::kTracked) return false;
  const double shift = q.T_last_keyframe_camera.translation.norm() / median_depth_m(*q.frame.features);
  const double angle_rad = q.T_last_keyframe_camera.angle_rad();
  if (angle_rad > options.max_angle_rad || shift > options.max_shift) return true;

  const int tracked = q.result.stats.inliers;
  const bool view_thins_out = tracked < options.min_tracked_share * q.reference_landmarks;
  const bool blind_soon = tracked < options.min_landmarks &&
                          unmapped_with_depth(q.result, *q.frame.features) > options.min_unmapped;
  // A camera that stands still sees nothing new, however long it stands.
  const double moved = std::max(angle_rad / options.max_angle_rad, shift / options.max_shift);
  constexpr double kHardlyMoved = 0.25;
  if (moved < kHardlyMoved) return false;
  return view_thins_out || blind_soon || q.frames_since_keyframe >= options.max_gap_frames;
}

int confirmed_landmarks(const Map& map, KeyframeId id) {
  int count = 0;
  for (const LandmarkId landmark : map.keyframe(id).landmark_of) {
    count += landmark.valid() && map.landmark(landmark).observations.size() >= 2 ? 1 : 0;
  }
  return count;
}

KeyframeId best_reference(const Map& map, const std::vector<LandmarkMatch>& matches, KeyframeId fallback) {
  std::vector<int> shared(map.keyframes().size(), 0);
  for (const LandmarkMatch& match : matches) {
    if (!map.contains(match.landmark)) continue;
    for (const auto& observation : map.landmark(match.landmark).observations)
      ++shared[observation.keyframe.value];
  }
  const auto most = std::max_element(shared.begin(), shared.end());
  if (most == shared.end() || *most == 0) return fallback;
  return KeyframeId{static_cast<uint32_t>(most - shared.begin())};
}

}  // namespace kinloop
