#pragma once
// Tracks a frame relative to the previous one: guided matching first, brute force if the motion was
// unexpected, dense alignment of depth and grey images if features fail.

#include <optional>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/tracking/frame.hpp"
#include "kinloop/tracking/motion_model.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

/// A pose and the observations that support it.
struct FramePose {
  SE3 T_reference_camera;
  Matrix6d information = Matrix6d::Zero();
  std::vector<PoseObservation> support;  ///< inliers only
  std::vector<uint32_t> features;        ///< the keypoint of each element of `support`
  int attempts = 0;
  bool from_brute_force = false;  ///< from matches found without a prediction
  bool dense = false;             ///< from dense alignment, without support
};

/// Estimates the pose of `frame` by the first of these methods with a reliable result: matching keypoints of
/// `previous` within the uncertainty of the prediction, in wider windows, by brute force with RANSAC (P3P,
/// then rigid 3D-3D). If none is reliable, returns the result with the most support; if there is none, that
/// of dense alignment; nullopt if all fail.
std::optional<FramePose> estimate_pose_from_previous_frame(
    const PreparedFrame& frame, const FeatureGrid& grid, const TrackedFrame& previous,
    const LocalMap& local_map, const PredictedPose& predicted, const PinholeCamera& camera,
    const TrackingOptions& options, uint64_t seed);

}  // namespace kinloop
