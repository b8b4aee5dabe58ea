#pragma once
// Tracks a frame by its keypoints against the previous frame and the local map, starting from a predicted
// pose. Pure functions: the caller keeps all state.

#include "kinloop/features/matcher.hpp"
#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/sensor/sensor.hpp"
#include "kinloop/tracking/motion/motion_model.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

/// A frame and what it is tracked with. The frame is motion-compensated.
struct TrackingInput {
  const Frame& frame;
  const LocalMap& local_map;
  const Sensor& sensor;
  const TrackingOptions& options;
  FeatureGrid grid{*frame.features, sensor.camera.width, sensor.camera.height};
};

/// Tracks a frame against `previous` (whose pose is relative to the reference of the local map) and the local
/// map, starting from the predicted T_reference_camera. `seed` drives RANSAC. The result is lost if too few
/// landmarks agree.
TrackedFrame track_keypoints(const TrackingInput& in, const TrackedFrame& previous,
                             const PredictedPose& predicted, uint64_t seed);

/// Returns whether hardly any of the visible landmarks were matched although the image has the keypoints for
/// them: something else is in view.
bool misses_landmarks(const TrackedFrame& tracked, const Features& features);

/// Returns whether enough of the visible landmarks were matched (their number is limited by the frame's
/// keypoints). Chance matches can agree on a wrong pose, but then few landmarks are found at their
/// projections.
bool has_sufficient_inlier_ratio(const TrackedFrame& tracked, const Features& features,
                                 double min_inlier_ratio);

/// Matches the landmarks of the local map with keypoints of the frame near their projections under
/// `T_reference_camera_guess`, and refines the pose on them. `window_px` is the half side of the search
/// windows. Used by `track_keypoints` and for place recognition.
TrackedFrame track_local_map(const TrackingInput& in, const SE3& T_reference_camera_guess, double window_px);

/// The same for a frame of which more is known than its images.
TrackedFrame track_local_map(const TrackingInput& in, const SE3& T_reference_camera_guess, double window_px,
                             TrackedFrame without_pose);

/// Tracks by dense alignment with the previous frame; lost if that fails. Directions that its surfaces leave
/// open are decided by the motion before, and by landmarks, of which four are enough here.
TrackedFrame track_densely(const TrackingInput& in, const TrackedFrame& previous,
                           const PredictedPose& predicted);

}  // namespace kinloop
