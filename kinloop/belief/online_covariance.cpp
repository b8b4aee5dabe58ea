#include "kinloop/belief/online_covariance.hpp"

#include <algorithm>

#include "kinloop/belief/pose_scatter.hpp"
#include "kinloop/belief/relative_covariance.hpp"

namespace kinloop {
namespace {

// The variance that a keyframe adds is this many times that of its pose given the landmarks: the errors of
// successive keyframes are correlated (the same landmarks, a sensor that is not calibrated yet), and so grow
// faster than those of a random walk. Learned on simulated sequences with seeds 100 to 103
// (docs/lab/measurements.md#consistency-of-the-covariances).
constexpr double kDriftFactor = 5;
constexpr double kScatterFrames = 15;  // half a second

}  // namespace

Matrix6d covariance_of_scale(const SE3& T_first_pose, double scale_sigma) {
  Vector6d off = Vector6d::Zero();
  off.head<3>() = scale_sigma * (T_first_pose.rotation.conjugate() * T_first_pose.translation);
  return off * off.transpose();
}

Matrix6d OnlineCovariance::add(const TrackedFrame& tracked) {
  add_to_scatter(tracked);
  if (tracked.is_lost() || tracked.covariance.isZero(0)) return Matrix6d::Zero();
  make_room_for(tracked.reference);
  Matrix6d covariance = transported(keyframes_[tracked.reference.value], tracked.T_reference_camera) +
                        tracked.covariance + scatter_;
  if (const auto T = T_first_camera(tracked)) covariance += covariance_of_scale(*T, scale_sigma_);
  return covariance;
}

OdometryStep OnlineCovariance::add_keyframe(const TrackedFrame& tracked) {
  const KeyframeId keyframe = tracked.keyframe;
  make_room_for(keyframe);
  if (tracked.outcome == TrackingOutcome::kNewMap) {
    T_first_keyframe_[keyframe.value] = SE3{};
    return {};
  }
  make_room_for(tracked.reference);
  const Matrix6d drift = kDriftFactor * tracked.covariance;
  keyframes_[keyframe.value] =
      transported(keyframes_[tracked.reference.value], tracked.T_reference_camera) + drift;
  T_first_keyframe_[keyframe.value] = T_first_camera(tracked);
  return {tracked.reference, drift};
}

void OnlineCovariance::make_room_for(KeyframeId id) {
  if (id.value < keyframes_.size()) return;
  keyframes_.resize(id.value + 1, Matrix6d::Zero());
  T_first_keyframe_.resize(id.value + 1);
}

/// The pose in the keyframe that started the component; none in a loaded map.
std::optional<SE3> OnlineCovariance::T_first_camera(const TrackedFrame& tracked) const {
  const auto& T_first_reference = T_first_keyframe_[tracked.reference.value];
  if (!T_first_reference) return std::nullopt;
  return *T_first_reference * tracked.T_reference_camera;
}

void OnlineCovariance::add_to_scatter(const TrackedFrame& tracked) {
  if (tracked.is_repeat()) return;
  if (tracked.outcome != TrackingOutcome::kTracked || tracked.method == TrackingMethod::kDense) {
    latest_.clear();
    return;
  }
  latest_.push_back({tracked.stamp_ns, tracked.T_world_camera});
  if (latest_.size() > 3) latest_.pop_front();
  if (latest_.size() < 3) return;
  const auto off = off_constant_motion(latest_[0], latest_[1], latest_[2]);
  if (!off) return;
  frames_ = std::min(frames_ + 1, kScatterFrames);
  scatter_ += (*off * off->transpose() - scatter_) / frames_;
}

}  // namespace kinloop
