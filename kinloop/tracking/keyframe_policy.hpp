#pragma once
// Which frames become keyframes: those that show what no keyframe shows yet. A camera that comes back to a
// mapped place makes none, so that the map is bounded by what there is to see.

#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// What the decision to make a keyframe rests on.
struct KeyframeCriteria {
  const TrackResult& result;
  const PreparedFrame& frame;
  std::vector<SE3> T_keyframe_camera;  ///< motion from the keyframes that show the same place
  int frames_since_keyframe = 0;
  int reference_landmarks = 0;  ///< landmarks that the reference keyframe shows and others confirm
};

/// Whether the frame shows enough that is new, or too little that is known, to become a keyframe.
bool needs_keyframe(const KeyframeCriteria& criteria, const KeyframeOptions& options);

/// Motion to the camera from the last keyframe, and from those that show a fair share of its landmarks.
std::vector<SE3> motions_from_keyframes(const Map& map, const TrackResult& result, KeyframeId last);

/// Landmarks of a keyframe that at least one other keyframe confirms.
int count_confirmed_landmarks(const Map& map, KeyframeId id);

/// The keyframe that shares most of the matched landmarks, which should be the reference of the local map;
/// the lower id of equals, `fallback` where none shares any.
KeyframeId best_reference(const Map& map, const std::vector<LandmarkMatch>& matches, KeyframeId fallback);

}  // namespace kinloop
