#pragma once
// What a run does at its end, when no further frame comes.

#include <vector>

#include "kinloop/back_end/options.hpp"
#include "kinloop/back_end/self_calibration.hpp"
#include "kinloop/core/progress.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"

namespace kinloop {

// Bundle adjustment of the whole map to convergence together with the sensor parameters, completion of tracks
// over all keyframes, and refinement of every frame pose on the final map.

struct FinalBundleAdjustment {
  SensorEstimate sensor;
  /// Per keyframe, the covariance of x = (translation [m]; rotation [rad]), where the true pose is
  /// T_world_camera * exp(x), relative to the first keyframe of its component (whose covariance is zero).
  /// Without what the keypoints of a frame share, see pose_covariances. Empty if `progress` stopped early.
  std::vector<Matrix6d> keyframe_covariance;
};

/// Adjusts `map` and refines `log`, starting from the given sensor estimate.
FinalBundleAdjustment final_bundle_adjustment(Map& map, FrameLog& log, const SensorEstimate& initial_estimate,
                                              const BackEndOptions& options, const Progress& progress = {});

// Takes back landmarks on things that have moved. Some are recognised as such too late: a person who walks in
// view when the map begins, or who stood still until then. Keyframes made at other times saw through the
// place.

/// Erases the landmarks through which at least two keyframes saw, and more than found a surface there. Those
/// that observe a landmark have no say. Landmarks without measured depth stay, and those on things too thin
/// for the surfaces. Returns how many are erased.
size_t erase_moved_landmarks(Map& map);

// How far the keyframes of a run may have drifted after the final adjustment.

/// Adds to the covariances of the final adjustment (by id, see FinalBundleAdjustment; empty: none) those of
/// the drift. The errors of successive keyframes are correlated, which no residual of the adjustment shows,
/// and so add up along the steps of odometry, until the camera sees again what it had left: that ties both
/// visits together. Where no landmarks tie a part to what was before, a step alone tells how it lies there.
/// Keyframes without a step, those of loaded maps, are exact.
std::vector<Matrix6d> with_drift(std::vector<Matrix6d> covariance, const Map& map);

// The covariances of all poses after the final adjustment.

/// Covariances of x = (translation [m]; rotation [rad]), where the true pose is T_world_camera * exp(x),
/// relative to the first keyframe of its component.
struct PoseCovariances {
  std::vector<Matrix6d> keyframes;  ///< by id; zero for the first of each component
  std::vector<Matrix6d> frames;     ///< by index in the log; zero if lost or unknown
};

/// Adds to the covariances of the keyframes (by id, relative to the first of the component; those beyond the
/// end are zero) and of the frames given the landmarks (EstimatedFrame::covariance) what the keypoints of a
/// frame share: the scatter of the poses around it and around the first keyframe (pose_scatter). Also adds
/// what an error of the scale of all depths does (1 sigma, relative), which grows with the distance.
PoseCovariances pose_covariances(const FrameLog& log, const Map& map,
                                 const std::vector<Matrix6d>& keyframe_covariance, double scale_sigma = 0);

// Gives poses to frames that no measurement holds: between good ones, the camera has not gone far.

/// Returns the log with poses for frames that are lost, or whose image was frozen, between two measured ones
/// of one component that are at most 3 s apart. Their covariance tells how far the camera may have gone
/// meanwhile, given how it moves elsewhere in the log (see bridge_motion); where the standard deviation of
/// the position exceeds `max_sigma_m` they are doubtful. Where it does not, a recognized place that no later
/// frame has confirmed is confirmed if the prediction explains it. Frames before `first` are left as they
/// are.
FrameLog predict_unmeasured_frames(FrameLog log, size_t first, const Map& map, double max_sigma_m);

}  // namespace kinloop
