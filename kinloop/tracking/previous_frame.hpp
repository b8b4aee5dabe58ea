#pragma once
// Tracks a frame relative to the previous one: guided matching first, brute force if the motion was
// unexpected, dense alignment of depth and grey images if features fail.

#include <optional>

#include "kinloop/tracking/keypoint_tracking.hpp"

namespace kinloop {

/// A pose and the observations that agree with it.
struct FramePose {
  SE3 T_reference_camera;
  Matrix6d information = Matrix6d::Zero();
  std::vector<PoseObservation> inliers;
  std::vector<uint32_t> features;  ///< the keypoint of each inlier
  int matches = 0;                 ///< tried
  int attempts = 0;
  bool from_brute_force = false;  ///< from matches found without a prediction
  bool dense = false;             ///< from dense alignment, without inliers
};

/// Estimates the pose of the frame by the first of these methods with a reliable result: matching keypoints
/// of `previous` within the uncertainty of the prediction, in wider windows, by brute force with RANSAC (P3P,
/// then rigid 3D-3D). If none is reliable, returns the result with the most inliers; if there is none, that
/// of dense alignment; nullopt if all fail.
std::optional<FramePose> estimate_pose_from_previous_frame(const TrackingInput& in,
                                                           const TrackedFrame& previous,
                                                           const PredictedPose& predicted, uint64_t seed);

/// Estimates the pose by dense alignment with the previous frame alone.
std::optional<FramePose> align_with_previous_frame(const TrackingInput& in, const TrackedFrame& previous,
                                                   const SE3& T_reference_camera_guess);

}  // namespace kinloop
