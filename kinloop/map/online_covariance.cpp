#include "kinloop/map/online_covariance.hpp"

#include <algorithm>

#include "kinloop/map/pose_scatter.hpp"

namespace kinloop {
namespace {

// The variance that a keyframe adds is this many times that of its pose given the landmarks: the errors of
// successive keyframes are correlated (the same landmarks, a sensor that is not calibrated yet), and so grow
// faster than those of a random walk. Learned on simulated sequences with seeds 100 to 103
// (docs/measurements.md#consistency-of-the-covariances).
constexpr double kDriftFactor = 5;
constexpr double kScatterFrames = 15;  // half a second

}  // namespace

Matrix6d transported(const Matrix6d& covariance_of_T_a_b, const SE3& T_b_c) {
  const Matrix6d adjoint = T_b_c.inverse().adjoint();
  return adjoint * covariance_of_T_a_b * adjoint.transpose();
}

Matrix6d OnlineCovariance::add(const TrackedFrame& tracked) {
  add_to_scatter(tracked);
  if (tracked.is_lost()) return Matrix6d::Zero();
  const auto slot = [this](KeyframeId id) -> Matrix6d& {
    if (keyframes_.size() <= id.value) keyframes_.resize(id.value + 1, Matrix6d::Zero());
    return keyframes_[id.value];
  };
  if (tracked.outcome == TrackingOutcome::kNewMap) return Matrix6d::Zero();
  const Matrix6d of_reference = transported(slot(tracked.reference), tracked.T_reference_camera);
  if (tracked.keyframe.valid()) slot(tracked.keyframe) = of_reference + kDriftFactor * tracked.covariance;
  if (tracked.covariance.isZero(0)) return Matrix6d::Zero();
  return of_reference + tracked.covariance + scatter_;
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
