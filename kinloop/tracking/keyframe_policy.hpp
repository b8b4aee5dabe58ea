#pragma once
// Keyframe selection: a frame becomes a keyframe if it shows content not covered by existing keyframes. A
// camera that revisits a mapped place adds none, so the size of the scene bounds the size of the map.

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

/// Returns the options for a frame that was tracked directly: keyframes are 1.5 times as far apart.
/// Patches follow a landmark over a larger change of scale and parallax than descriptors, and tie all
/// frames in between to the same keyframe; a rotation brings new content into view in either case.
KeyframeOptions spaced_for_direct_tracking(KeyframeOptions options);

/// Returns the camera motion from the nearest keyframe, relative to the motion at which a frame always
/// becomes a keyframe (1); infinite without keyframes.
double motion_from_nearest(const Features& features, std::span<const SE3> T_keyframe_camera,
                           const KeyframeOptions& options);

/// What the decision depends on.
struct KeyframeCriteria {
  const TrackedFrame& tracked;
  std::vector<SE3> T_keyframe_camera;  ///< motion relative to the keyframes that show the same place
  int frames_since_keyframe = 0;
  int reference_landmarks = 0;  ///< landmarks of the reference keyframe confirmed by other keyframes
};

/// Returns whether the pose of a frame is good enough for a keyframe. Where evidence is only weak, at the end
/// of the map or after a blur, the map goes on with the uncertainty of the pose; a camera that waits for
/// landmarks there never sees one again.
bool may_extend_map(const TrackedFrame& tracked);

/// Returns whether the frame should become a keyframe, because it shows enough new content or too few known
/// landmarks.
bool needs_keyframe(const KeyframeCriteria& criteria, const KeyframeOptions& options);

/// Returns the motion to the camera from the newest keyframe, unless that is in another component, and from
/// every keyframe that observes a fair share of the frame's landmarks. Empty if there is no such keyframe.
std::vector<SE3> motions_from_keyframes(const Map& map, const TrackedFrame& tracked);

/// Returns the keyframe that shares the most matched landmarks, the best reference of the local map; ties go
/// to the lower id, `fallback` if none shares any.
KeyframeId best_reference(const Map& map, const std::vector<LandmarkMatch>& matches, KeyframeId fallback);

/// Decides which frames become keyframes.
class KeyframeSelector {
 public:
  /// Matches all keypoints of a frame that was tracked by patches.
  using Rematch = std::function<TrackedFrame(const TrackedFrame&)>;

  explicit KeyframeSelector(const KeyframeOptions& options) : options_(options) {}

  /// Returns the frame, with all of its keypoints matched, if it should become a keyframe: if it starts a
  /// map, or if it is located and shows enough new content.
  [[nodiscard]] std::optional<TrackedFrame> select(const TrackedFrame& tracked, const Map& map,
                                                   const Rematch& rematch);

 private:
  [[nodiscard]] bool is_worth_rematching(const TrackedFrame& tracked, double moved) const;

  KeyframeOptions options_;
  std::optional<int64_t> last_rematched_ns_;
};

}  // namespace kinloop
