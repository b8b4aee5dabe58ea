#pragma once
// A frame after tracking: its pose with the evidence for it, and the landmarks it observes.

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/velocity.hpp"
#include "kinloop/map/frames/frame_record.hpp"
#include "kinloop/sensor/frame.hpp"
#include "kinloop/sensor/surfaces/surface_grid.hpp"

namespace kinloop {

/// Keypoint `feature` of the frame observes `landmark`.
struct LandmarkMatch {
  LandmarkId landmark;
  uint32_t feature = 0;
};

/// What is known of the images of a frame, without its pose.
struct InputEvidence {
  double fixed_share = 0;   ///< of the image, that moves with the camera
  double depth_factor = 1;  ///< by which depth was multiplied, see DepthContinuity; 0 = none was used
};

/// What supports the pose of a frame.
struct TrackingEvidence {
  int visible_landmarks = 0;  ///< landmarks of the local map in view
  int inliers = 0;            ///< landmarks matched consistently with the pose
  int with_depth = 0;         ///< of these, those of which a keyframe has measured the depth
  int attempts = 0;  ///< number of methods tried against the previous frame (1 = the first succeeded)
  SurfaceAgreement surfaces;  ///< with the reference keyframe, without what has moved; zero if unknown
  double moved_share = 0;     ///< of the image, that belongs to things that have moved
  InputEvidence input;
};

/// What a run estimates of a frame.
struct EstimatedFrame : FrameRecord {
  /// Of the reference keyframe when the frame was tracked: loops may have joined or split components since.
  uint32_t component = 0;
  uint32_t visit = 0;  ///< in which the camera was, see Keyframe::visit
  /// Of x = (translation [m]; rotation [rad]), where the true pose is T_reference_camera * exp(x), given the
  /// landmarks. Zero if unknown.
  Matrix6d covariance = Matrix6d::Zero();
  /// The same of the pose in the world relative to the first keyframe of its component; after the end of the
  /// run, of the final pose in the map. Zero if unknown.
  Matrix6d world_covariance = Matrix6d::Zero();
  Velocity velocity;  ///< at the stamp; zero if unknown
  TrackingEvidence evidence;
  std::vector<LandmarkMatch> matches;  ///< observed landmarks
};

/// A frame while it is new: as the tracker makes it and listeners receive it.
struct TrackedFrame : EstimatedFrame {
  SE3 T_world_camera;  ///< at the time of tracking, before later corrections
  /// Where the frame of the odometry is in the map: T_map_odom^-1 * T_world_camera does not jump when the map
  /// is corrected or a place recognized, see OdometryFrame.
  SE3 T_map_odom;
  /// Whether the place was recognized and later frames have not confirmed it yet.
  bool provisional = false;
  cv::Mat moved;                       ///< the points of the surface grid that have moved, see moved_points
  std::shared_ptr<const Frame> frame;  ///< motion-compensated, with images and features

  /// Returns the features of `frame`, which must not be null.
  [[nodiscard]] const Features& features() const { return *frame->features; }
};

/// Takes the pose from a frame, with the landmarks that support it.
void lose(EstimatedFrame& frame);

/// Returns the record of a frame that is not located yet. The frame must have features.
TrackedFrame unlocated(const Frame& frame);

/// Returns the record without the pose and the landmarks that support it.
TrackedFrame without_pose(TrackedFrame tracked);

/// Returns the standard deviation of the position along its least certain direction, m, given the covariance
/// of a pose; 0 if unknown.
double position_sigma_m(const Matrix6d& covariance);

/// Returns the landmark that each keypoint of the frame observes; invalid if none.
std::vector<LandmarkId> landmark_of_keypoint(const TrackedFrame& tracked);

/// Returns the covariance of a pose with this information. Directions without information get a variance of
/// 1e6 m^2 or rad^2.
Matrix6d covariance_from_information(const Matrix6d& information);

}  // namespace kinloop
