#pragma once

#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// What the decision to make a keyframe rests on.
struct KeyframeQuestion {
  const TrackResult& result;
  const PreparedFrame& frame;
  SE3 T_last_keyframe_camera;  ///< motion since the last keyframe
  int frames_since_keyframe = 0;
  int reference_landmarks = 0;  ///< landmarks that the reference keyframe shows and others confirm
};

/// Whether the frame shows enough that is new, or too little that is known, to become a keyframe.
bool needs_keyframe(const KeyframeQuestion& question, const KeyframeOptions& options);

/// Landmarks of a keyframe that at least one other keyframe confirms.
int confirmed_landmarks(const Map& map, KeyframeId id);

/// The keyframe that shares most of the matched landmarks, which should be the reference of the local view;
/// the lower id of equals, `fallback` where none shares any.
KeyframeId best_reference(const Map& map, const std::vector<LandmarkMatch>& matches, KeyframeId fallback);

}  // namespace kinloop
