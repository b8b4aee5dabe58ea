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

}  // namespace kinloop
