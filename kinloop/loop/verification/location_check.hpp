#pragma once
// Whether a camera is where one of its images was recognized. One image may look like another place, such as
// a room furnished alike; the next images show what is around it, at which distances.

#include <deque>

#include "kinloop/loop/verification/view_checks.hpp"
#include "kinloop/map/loop_closure.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/tracking/keypoint_tracking.hpp"

namespace kinloop {

/// What one frame says of the place where it was located.
struct LocationEvidence {
  RelativeScale scale;  ///< of the landmarks there, relative to the depth of the frame; unknown by default
  DepthConsistency depths;  ///< with the views of the map around the pose
  /// Of finding so few keypoints in some region of the image, see `appearance_p_value`: the second smallest
  /// of the three nearest views, so that one of them may show something that has moved since.
  double appearance_p_value = 1;
};

/// A frame and where it is thought to be.
struct LocatedView {
  uint32_t component = 0;
  SE3 T_world_camera;
  const Features& features;
};

/// Compares the keypoints of a frame with the nearest views of its component, of the keyframes before `end`.
/// Views more than 1 m or .7 rad away say nothing. The scale is left unknown.
LocationEvidence compare_with_views(const Map& map, KeyframeId end, const LocatedView& located,
                                    const Sensor& sensor);

/// Sums the evidence of successive frames.
class LocationCheck {
 public:
  /// Adds a frame. `confident` tells whether many landmarks agree with its pose.
  void add(const LocationEvidence& evidence, bool confident);

  /// Adds the look of a frame after the place was confirmed; a few a second are enough.
  void add_appearance(double appearance_p_value) { appearance_.add({appearance_p_value}); }

  /// Returns whether the camera is elsewhere: the place has another size, the latest frames lie in free
  /// space of the map, or in most of them a part of the view looks different. Also, after it was confirmed,
  /// whether too many frames look different, as those of another floor furnished alike.
  [[nodiscard]] bool is_contradicted() const;

  /// Returns whether two frames agree with the place; once true, it remains so. Without depth, nothing but
  /// landmarks supports a place: ten frames must be confident.
  [[nodiscard]] bool is_confirmed() const { return confirmed_; }

 private:
  [[nodiscard]] DepthConsistency depths() const;
  [[nodiscard]] RelativeScale scale() const;
  [[nodiscard]] bool appearance_contradicts() const;

  std::deque<LocationEvidence> latest_;
  int frames_ = 0, confident_frames_ = 0;
  AppearanceTally appearance_;
  bool confirmed_ = false;
};

}  // namespace kinloop
