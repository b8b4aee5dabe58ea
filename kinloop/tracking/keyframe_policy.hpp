#pragma once
// Keyframe selection: a frame becomes a keyframe if it shows content not covered by existing keyframes. A
// camera that revisits a mapped place adds none, so the size of the scene bounds the size of the map.

#include <span>

#include "kinloop/tracking/local_map_tracking.hpp"

namespace kinloop {

/// Input of the keyframe decision.
struct KeyframeCriteria {
  const TrackResult& result;
  const PreparedFrame& frame;
  std::vector<SE3> T_keyframe_camera;  ///< motion relative to the keyframes that show the same place
  int frames_since_keyframe = 0;
  int reference_landmarks = 0;  ///< landmarks of the reference keyframe confirmed by other keyframes
};

/// Below this motion from the nearest keyframe no frame becomes one: a static camera sees nothing new,
/// however long it stays.
inline constexpr double kMinKeyframeMotion = 0.5;

/// Returns the options for a frame that was tracked directly: keyframes half as far again from each other.
/// Patches follow a landmark over a larger change of scale and parallax than descriptors, and refer all
/// frames between to the same keyframe; a rotation brings new content into view in either case.
KeyframeOptions spaced_for_direct_tracking(KeyframeOptions options);

/// Returns the camera motion from the nearest keyframe, relative to the motion at which a frame always
/// becomes a keyframe (1).
double motion_from_nearest(const Features& features, std::span<const SE3> T_keyframe_camera,
                           const KeyframeOptions& options);

/// Returns whether the frame should become a keyframe, because it shows enough new or too few known
/// landmarks.
bool needs_keyframe(const KeyframeCriteria& criteria, const KeyframeOptions& options);

/// Returns the motion to the camera from the last keyframe, and from those that observe a fair share of its
/// landmarks.
std::vector<SE3> motions_from_keyframes(const Map& map, const TrackResult& result, KeyframeId last);

/// Returns the number of a keyframe's landmarks that at least one other keyframe observes.
int count_confirmed_landmarks(const Map& map, KeyframeId id);

/// Returns the keyframe that shares the most matched landmarks, the best reference of the local map; ties go
/// to the lower id, `fallback` if none shares any.
KeyframeId best_reference(const Map& map, const std::vector<LandmarkMatch>& matches, KeyframeId fallback);

}  // namespace kinloop
