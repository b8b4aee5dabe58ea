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

}  // namespace kinloop
