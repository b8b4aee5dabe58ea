#pragma once
// A frame after tracking: its outcome, its pose with the evidence for it, and the landmarks it observes. The
// tracker makes it, listeners receive it, the log and map files keep it.

#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "kinloop/core/ids.hpp"
#include "kinloop/features/features.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/geometry/velocity.hpp"
#include "kinloop/sensor/frame.hpp"
#include "kinloop/sensor/surfaces/surface_grid.hpp"

namespace kinloop {

/// How the tracking of a frame ended.
enum class TrackingOutcome {
  kLost,         ///< no pose
  kTracked,      ///< located relative to the previous frame and the local map
  kRelocalized,  ///< located by place recognition, or where the motion before did not lead
  kNewMap,       ///< starts a map, or a new component of it
};

/// What a pose was estimated from.
enum class TrackingMethod {
  kKeypoints,  ///< matched descriptors of landmarks, or of points of the previous frame
  kPatches,    ///< patches of landmarks (direct tracking)
  kDense,      ///< dense alignment with the previous frame, since there were too few features
  kRepeat,     ///< none: the image repeats the previous one, whose pose the frame takes
  kBridged,    ///< none: the motion between the frames before and after, see bridge_lost_frames
};

/// Keypoint `feature` of the frame observes `landmark`.
struct LandmarkMatch {
  LandmarkId landmark;
  uint32_t feature = 0;
};

/// The measurement of a match, kept when the images are dropped.
struct MatchMeasurement {
  Eigen::Vector2f pixel;  ///< undistorted, as measured
  float depth_m = 0;      ///< 0 = unknown
  float sigma_px = 1;
  float row = 0;  ///< raw image row relative to the height, -0.5 (first) to 0.5 (last)
  Eigen::Vector2f inverse_depth_gradient = Eigen::Vector2f::Zero();  ///< 1/m per px
};

/// What supports the pose of a frame.
struct TrackingEvidence {
  int previous_frame_inliers = 0;  ///< inliers of the pose relative to the previous frame
  int visible_landmarks = 0;       ///< landmarks of the local map in view
  int inliers = 0;                 ///< landmarks matched consistently with the pose
  int with_depth = 0;              ///< of these, those of which a keyframe has measured the depth
  int attempts = 0;  ///< number of methods tried against the previous frame (1 = the first succeeded)
  SurfaceAgreement surfaces;  ///< with the reference keyframe, without what has moved; zero if unknown
  double moved_share = 0;     ///< of the image, that belongs to things that have moved
  double fixed_share = 0;     ///< of the image, that moves with the camera
  double depth_factor = 1;    ///< by which depth was multiplied, see DepthContinuity; 0 = none was used
};

/// A frame with its pose and the support for it.
struct TrackedFrame {
  FrameId id;
  int64_t stamp_ns = 0;                ///< of the colour image
  float depth_stamp_difference_s = 0;  ///< stamp of the depth image minus `stamp_ns`
  TrackingOutcome outcome = TrackingOutcome::kLost;
  TrackingMethod method = TrackingMethod::kKeypoints;

  KeyframeId reference;    ///< the keyframe that the pose is relative to and moves with
  SE3 T_reference_camera;  ///< undefined if lost
  SE3 T_world_camera;      ///< at the time of tracking, before later corrections; not in map files
  /// Where the frame of the odometry is in the map: T_map_odom^-1 * T_world_camera does not jump when the map
  /// is corrected or a place recognized, see OdometryFrame. Not in map files.
  SE3 T_map_odom;
  /// Of x = (translation [m]; rotation [rad]), where the true pose is T_reference_camera * exp(x), given the
  /// landmarks. Zero if unknown.
  Matrix6d covariance = Matrix6d::Zero();
  /// The same of T_world_camera relative to the first keyframe of its component; after the end of the run, of
  /// the final pose in the map. Zero if unknown. Not in map files.
  Matrix6d world_covariance = Matrix6d::Zero();
  Velocity velocity;  ///< at the stamp; zero if unknown
  TrackingEvidence evidence;
  /// Whether the evidence is too weak to trust the pose: it may be wrong by more than its covariance says.
  bool doubtful = false;
  /// Whether the place was recognized and later frames have not confirmed it yet; not in map files.
  bool provisional = false;
  cv::Mat moved;  ///< the points of the surface grid that have moved, see moved_points; not in the log
  std::vector<LandmarkMatch> matches;          ///< observed landmarks
  std::vector<MatchMeasurement> measurements;  ///< of `matches`; in the log only

  KeyframeId keyframe;   ///< valid if the frame became a keyframe
  bool refined = false;  ///< refined during the run, measurements dropped (see LogLimiter)
  /// The motion-compensated frame. The log keeps it only for lost frames, with features but no images, to
  /// relocalize them in the final map.
  std::shared_ptr<const Frame> frame;

  /// Whether the frame has no pose.
  [[nodiscard]] bool is_lost() const { return outcome == TrackingOutcome::kLost; }

  /// Whether the frame was located in the existing map.
  [[nodiscard]] bool is_located() const {
    return outcome == TrackingOutcome::kTracked || outcome == TrackingOutcome::kRelocalized;
  }

  /// Whether landmarks support the pose.
  [[nodiscard]] bool is_tracked_by_landmarks() const {
    return !is_lost() && method != TrackingMethod::kDense && method != TrackingMethod::kBridged;
  }

  /// Whether the image repeats the previous one.
  [[nodiscard]] bool is_repeat() const { return method == TrackingMethod::kRepeat; }

  /// Returns the features of `frame`, which must not be null.
  [[nodiscard]] const Features& features() const { return *frame->features; }
};

/// Returns the record of a frame that is not located yet. The frame must have features.
TrackedFrame unlocated(const Frame& frame);

/// Returns the standard deviation of the position along its least certain direction, m, given the covariance
/// of a pose; 0 if unknown.
double position_sigma_m(const Matrix6d& covariance);

/// Returns the landmark that each keypoint of the frame observes; invalid if none.
std::vector<LandmarkId> landmark_of_keypoint(const TrackedFrame& tracked);

/// Returns the covariance of a pose with this information. Directions without information get a variance of
/// 1e6 m^2 or rad^2.
Matrix6d covariance_from_information(const Matrix6d& information);

}  // namespace kinloop
