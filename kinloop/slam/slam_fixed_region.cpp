// What moves with the camera is left out of the frames, and taken out of the map if it was there before it
// was found.

#include <algorithm>

#include "kinloop/sensor/surfaces/surface_mask.hpp"
#include "kinloop/slam/slam.hpp"

namespace kinloop {
namespace {

/// Share of the landmarks of a frame that lie at marked points.
double landmark_share(const TrackedFrame& tracked, const cv::Mat& marked) {
  if (tracked.matches.empty() || !tracked.frame->surfaces) return 0;
  const SurfaceCamera& camera = *tracked.frame->surfaces->camera;
  const auto count =
      std::count_if(tracked.matches.begin(), tracked.matches.end(), [&](const LandmarkMatch& match) {
        return is_marked(marked, camera, tracked.features().measured_pixels[match.feature]);
      });
  return static_cast<double>(count) / static_cast<double>(tracked.matches.size());
}

/// Removes what a keyframe shows and observes at marked points.
void remove_marked(Map& map, KeyframeId id, const cv::Mat& marked) {
  const Keyframe& keyframe = map.keyframe(id);
  if (!keyframe.surfaces) return;
  const std::vector<LandmarkId> landmark_of = keyframe.landmark_of;
  for (uint32_t feature = 0; feature < landmark_of.size(); ++feature) {
    if (landmark_of[feature].valid() &&
        is_marked(marked, *keyframe.surfaces->camera, keyframe.features->measured_pixels[feature]))
      map.remove_observation(landmark_of[feature], {id, feature});
  }
  map.set_surfaces(id, std::make_shared<const SurfaceGrid>(without_points(*keyframe.surfaces, marked)));
}

}  // namespace

Frame Slam::without_fixed_region(const Frame& frame) {
  const ScopedTimer timer(timings_, "camera-fixed region");
  // Depth that is missing or repeated says nothing of what moves.
  if (depth_.age_s() == 0 && fixed_region_.observe(frame)) withdraw_fixed_region();
  if (fixed_region_.points().empty()) return frame;
  return front_end_.ignore(frame, camera_mask(), IgnoreCause::kFixedToCamera);
}

/// Takes what has been found to move with the camera out of the keyframes made since it does. If most
/// landmarks of the previous frame were there, the poses since then are those of the region and not of the
/// camera: the keyframes are withdrawn, and tracking begins anew. If some were, the poses are in doubt, and
/// so they are if one was before: between doubtful poses few landmarks tell the camera from the region.
void Slam::withdraw_fixed_region() {
  constexpr double kCapturedShare = 0.5, kInfluencedShare = 0.1;
  const cv::Mat& marked = fixed_region_.points();
  const int64_t since_ns = fixed_region_.unchanged_since_ns();
  const TrackedFrame* previous = tracker_.previous();
  const double share = previous != nullptr ? landmark_share(*previous, marked) : 0;
  const bool captured = share > kCapturedShare;
  for (uint32_t i = 0; i < map_.keyframes().size(); ++i) {
    const Keyframe& keyframe = map_.keyframe(KeyframeId{i});
    if (keyframe.frame.value < earlier_.frame_count || keyframe.stamp_ns < since_ns) continue;
    if (captured) {
      map_.withdraw(keyframe.id);
    } else {
      remove_marked(map_, keyframe.id, marked);
    }
    map_changed_ = true;
  }
  if (share > kInfluencedShare || has_doubts_since(since_ns))
    doubt_frames_since(since_ns, captured ? DoubtCause::kWithdrawn : DoubtCause::kFixedRegion);
  if (captured) {
    tracker_.reset();
  } else {
    tracker_.update(map_, tracker_.reference());
  }
}

/// Returns whether a frame of this run since then is doubtful or lost.
bool Slam::has_doubts_since(int64_t since_ns) const {
  for (size_t i = log_.size(); i-- > earlier_.frame_count && log_[i].stamp_ns >= since_ns;) {
    if (log_[i].is_doubtful() || log_[i].is_lost()) return true;
  }
  return false;
}

/// Marks the frames of this run since then. Those whose keyframe was withdrawn have no pose any more.
void Slam::doubt_frames_since(int64_t since_ns, DoubtCause cause) {
  for (size_t i = earlier_.frame_count; i < log_.size(); ++i) {
    LoggedFrame& entry = log_[i];
    if (entry.stamp_ns < since_ns || entry.is_lost()) continue;
    doubt(entry, cause);
    if (cause == DoubtCause::kWithdrawn && map_.keyframe(entry.reference).stamp_ns >= since_ns) lose(entry);
  }
}

cv::Mat Slam::camera_mask() const {
  if (fixed_region_.points().empty()) return {};
  const PinholeCamera& camera = camera_.color;
  return unmarked_pixels(*fixed_region_.camera(), fixed_region_.points(), {camera.width, camera.height});
}

}  // namespace kinloop
