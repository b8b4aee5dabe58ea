#pragma once
// In: frames as they are tracked. Out: the covariance of each pose in the map of that moment.

#include <deque>
#include <optional>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/map/frames/tracked_frame.hpp"

namespace kinloop {

/// Returns the covariance that an error of the scale of all depths (1 sigma, relative) causes, of x in the
/// axes of the pose: it grows with the distance.
Matrix6d covariance_of_scale(const SE3& T_first_pose, double scale_sigma);

/// The covariances of the poses of a run, as they are known at each frame.
///
/// A keyframe inherits the covariance of the keyframe that it was tracked against, and adds its own. So it
/// grows with the number of keyframes between a pose and the first one, and falls when the camera is back at
/// an old one. Corrections of the map are not followed: after a loop it is an upper bound.
class OnlineCovariance {
 public:
  /// `scale_sigma` is the relative error of the scale of all depths, 1 sigma.
  explicit OnlineCovariance(double scale_sigma = 0) : scale_sigma_(scale_sigma) {}

  /// Returns the covariance of x = (translation [m]; rotation [rad]), where the true pose is T_world_camera *
  /// exp(x), relative to the keyframe that started the component. Zero if unknown. Call once a frame.
  Matrix6d add(const TrackedFrame& tracked);

  /// Records the covariance of a frame that has become a keyframe, and returns the step to it, with drift.
  OdometryStep add_keyframe(const TrackedFrame& tracked);

  /// Returns the covariance of each keyframe, by its id. Those of loaded maps are zero: the map is the
  /// reference.
  [[nodiscard]] const std::vector<Matrix6d>& keyframes() const { return keyframes_; }

 private:
  void make_room_for(KeyframeId id);
  [[nodiscard]] std::optional<SE3> T_first_camera(const TrackedFrame& tracked) const;
  void add_to_scatter(const TrackedFrame& tracked);

  double scale_sigma_;
  std::vector<Matrix6d> keyframes_;
  std::vector<std::optional<SE3>> T_first_keyframe_;  // in the component, by id; none for loaded maps
  std::deque<StampedPose> latest_;                    // at most three
  Matrix6d scatter_ = Matrix6d::Zero();               // see pose_scatter, of the frames until now
  double frames_ = 0;                                 // that it is averaged over
};

}  // namespace kinloop
