#include "kinloop/belief/online_covariance.hpp"

#include <gtest/gtest.h>

#include "kinloop/belief/relative_covariance.hpp"

namespace kinloop {
namespace {

constexpr double kVariance = 1e-6;  // of a pose given the landmarks, m^2 and rad^2

/// A frame tracked against `reference` from 1 m beside it, which becomes `keyframe` if that is valid.
TrackedFrame tracked(KeyframeId reference, KeyframeId keyframe = {}) {
  TrackedFrame frame;
  frame.outcome = TrackingOutcome::kTracked;
  frame.reference = reference;
  frame.T_reference_camera.translation.x() = 1;
  frame.covariance = kVariance * Matrix6d::Identity();
  frame.keyframe = keyframe;
  return frame;
}

/// Adds a frame, and the keyframe that it becomes, if any.
Matrix6d add(OnlineCovariance& covariance, const TrackedFrame& frame) {
  if (frame.keyframe.valid()) covariance.add_keyframe(frame);
  return covariance.add(frame);
}

TrackedFrame first_frame() {
  TrackedFrame frame;
  frame.outcome = TrackingOutcome::kNewMap;
  frame.reference = frame.keyframe = KeyframeId{0};
  return frame;
}

TEST(OnlineCovariance, GrowsFromKeyframeToKeyframeAndFallsAtAnOldOne) {
  OnlineCovariance covariance;
  EXPECT_TRUE(add(covariance, first_frame()).isZero(0));
  double last = 0;
  for (uint32_t k = 1; k < 6; ++k) {
    const double sigma = position_sigma_m(add(covariance, tracked(KeyframeId{k - 1}, KeyframeId{k})));
    EXPECT_GT(sigma, last);
    last = sigma;
  }
  const double back = position_sigma_m(add(covariance, tracked(KeyframeId{0})));
  EXPECT_NEAR(back, std::sqrt(kVariance), 1e-9);
  EXPECT_EQ(covariance.keyframes().size(), 6U);
  EXPECT_TRUE(covariance.keyframes()[0].isZero(0));
}

TEST(OnlineCovariance, AnAngleMovesWhatIsFarAway) {
  Matrix6d turned = Matrix6d::Zero();
  turned(4, 4) = 1e-4;  // about y
  SE3 T_b_c;
  T_b_c.translation.z() = 3;
  EXPECT_NEAR(position_sigma_m(transported(turned, T_b_c)), 3e-2, 1e-12);
  EXPECT_EQ(position_sigma_m(turned), 0);
}

TEST(OnlineCovariance, AnErrorOfTheScaleGrowsWithTheDistanceFromTheFirstKeyframe) {
  OnlineCovariance exact, scaled(0.01);
  for (OnlineCovariance* covariance : {&exact, &scaled}) add(*covariance, first_frame());
  TrackedFrame far = tracked(KeyframeId{0}, KeyframeId{1}), farther = tracked(KeyframeId{1});
  far.T_reference_camera.translation = {0, 0, 4};
  farther.T_reference_camera.translation = {0, 0, 1};
  farther.T_world_camera.translation = {7, 7, 7};  // the world may have been moved since
  add(exact, far), add(scaled, far);
  const Matrix6d difference = add(scaled, farther) - add(exact, farther);
  EXPECT_NEAR(std::sqrt(difference(2, 2)), 0.05, 1e-9);
  EXPECT_NEAR(difference.norm(), difference(2, 2), 1e-12);
}

TEST(OnlineCovariance, IsZeroIfUnknownOrLost) {
  OnlineCovariance covariance;
  add(covariance, first_frame());
  add(covariance, tracked(KeyframeId{0}, KeyframeId{1}));
  TrackedFrame unknown = tracked(KeyframeId{1}), lost = unknown;
  unknown.covariance.setZero();
  lost.outcome = TrackingOutcome::kLost;
  EXPECT_TRUE(add(covariance, unknown).isZero(0));
  EXPECT_TRUE(add(covariance, lost).isZero(0));
}

}  // namespace
}  // namespace kinloop
