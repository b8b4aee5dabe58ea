#pragma once
// The covariances of all poses after the final adjustment.

#include <vector>

#include "kinloop/map/frames/frame_log.hpp"

namespace kinloop {

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

}  // namespace kinloop
