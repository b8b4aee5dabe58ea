#pragma once
// The covariance of the pose of one keyframe relative to another, and the test of a measured pose against it.
// It adds up along the shortest path of odometry and loop closures between the two,
//
//   Sigma(a, c) = Ad(T_c_b) Sigma(a, b) Ad(T_c_b)^T + Sigma(b, c),
//
// with the covariance of each step of tracking, and with drift that grows with the length of the whole path.
// That is an upper bound of the marginal covariance of the whole graph (Olson 2009, "Recognizing places using
// spectrally clustered local matches"). Each Sigma is that of x = (translation [m]; rotation [rad]), where
// the true pose is T_a_b * exp(x).

#include <optional>
#include <vector>

#include "kinloop/map/map.hpp"

namespace kinloop {

/// A relative pose that the map predicts, and the covariance of x.
struct PredictedView {
  SE3 T_reference_camera;
  Matrix6d covariance = Matrix6d::Zero();
};

/// Returns the pose of `b` in the reference of `a`, where `b` is relative to the camera of `a`.
PredictedView operator*(const PredictedView& a, const PredictedView& b);

/// The size of an error of a pose, in its least certain directions.
struct ErrorMagnitude {
  double translation_m = 0;
  double rotation_rad = 0;
};

/// Returns the covariance of T_a_c = T_a_b * T_b_c that the covariance of T_a_b causes.
Matrix6d transported(const Matrix6d& covariance_of_T_a_b, const SE3& T_b_c);

/// Returns the covariance that systematic errors of odometry (calibration, rolling shutter) add over a path:
/// they do not average out, so that the standard deviation grows with the length. A turn counts as one metre
/// per radian, since rotation drifts too.
Matrix6d drift_covariance(double length_m);

/// Returns the pose that a loop closure measures, in the direction from a to b.
PredictedView measured_view(const LoopClosure& loop);

/// The poses of all keyframes relative to one, by the shortest paths of odometry and loop closures to them.
class RelativePoses {
 public:
  RelativePoses(const Map& map, KeyframeId from);

  /// Returns the length of the path to a keyframe, m; infinity without one.
  [[nodiscard]] double path_length_m(KeyframeId to) const { return lengths_m_[to.value]; }

  /// Returns the pose of a keyframe relative to `from`; nullopt without a path.
  [[nodiscard]] std::optional<PredictedView> pose_of(KeyframeId camera) const;

  /// Returns the pose of `from` relative to a keyframe; nullopt without a path.
  [[nodiscard]] std::optional<PredictedView> seen_from(KeyframeId reference) const;

 private:
  std::vector<double> lengths_m_;     // by keyframe
  std::vector<PredictedView> views_;  // by keyframe, relative to `from`
};

/// Returns the square of the Mahalanobis distance of a measured pose from the predicted one: chi-square with
/// six degrees of freedom. Allows for the error of a pose that is measured by matched keypoints.
double squared_distance(const PredictedView& predicted, const SE3& T_reference_camera);

/// Returns whether the covariance explains the difference: one in a million true poses is refused.
bool is_explained(const PredictedView& predicted, const SE3& T_reference_camera);

/// Returns the standard deviation of the difference of a measured pose from the predicted one.
ErrorMagnitude expected_error(const Matrix6d& covariance);

/// Returns the largest difference that the covariance explains in one direction.
ErrorMagnitude largest_error(const Matrix6d& covariance);

/// Returns the largest angle by which an error displaces the direction of a point at `p_camera`, rad.
double displaced_rad(const ErrorMagnitude& error, const Eigen::Vector3d& p_camera);

/// Returns whether at least `min_keypoints` keypoints of `reference` with depth could appear in the camera's
/// view.
bool may_overlap(const Features& reference, const PredictedView& predicted, const PinholeCamera& camera,
                 int min_keypoints);

}  // namespace kinloop
