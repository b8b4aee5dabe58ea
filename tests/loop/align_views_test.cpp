#include "kinloop/loop/verification/align_views.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "kinloop/loop/verification/view_checks.hpp"
#include "tests/loop/room_views.hpp"
#include "tests/sensor/vga_surfaces.hpp"

namespace kinloop {
namespace {

using test::camera_at;

/// Two views whose relative pose is as drift has left it.
class AlignViews : public test::RoomViews {
 protected:
  [[nodiscard]] std::optional<AlignedViews> align(double travelled_m) const {
    return align_views({a_}, {b_}, {T_a_b_ * drift_, drift_covariance(travelled_m)}, sensor_);
  }

  /// Changes the pictures in the middle of the second view.
  void repaint_middle(double size_px) {
    Random random(3);
    in_window(size_px, [&](int row) { repaint(row, random); });
  }

  const Sensor sensor_{world_.camera};
  const SE3 T_a_b_ = T_world_a_.inverse() * T_world_b_;
  const SE3 drift_ = camera_at(0.015, {0.06, -0.04, 0.03});
};

constexpr double kTravelled_m = 3;

TEST_F(AlignViews, TakesDriftBack) {
  const auto aligned = align(kTravelled_m);
  ASSERT_TRUE(aligned);
  const SE3 error = T_a_b_.inverse() * aligned->T_reference_camera;
  EXPECT_LT(error.translation.norm(), 0.01);
  EXPECT_LT(error.angle_rad(), 0.003);
}

TEST_F(AlignViews, OneSceneHasOneSize) {
  const RelativeScale scale = align(kTravelled_m)->scale;
  EXPECT_NEAR(scale.factor, 1, 0.004);
  EXPECT_LT(scale.sigma, 0.005);
}

TEST_F(AlignViews, TheDoubleOfASceneHasAnother) {
  for (float& depth_m : b_.depths_m) depth_m *= 0.97F;
  const auto aligned = align(5);
  ASSERT_TRUE(aligned);
  EXPECT_NEAR(aligned->scale.factor, 1 / 0.97, 0.006);
}

TEST_F(AlignViews, WhatMovesHasNoSayInTheSize) {
  const cv::Mat nothing_m(480, 640, CV_32FC1, cv::Scalar(0));
  const SurfaceGrid moving = make_surface_grid(test::vga_surface_camera(), nothing_m);
  const auto aligned =
      align_views({a_, &moving}, {b_}, {T_a_b_ * drift_, drift_covariance(kTravelled_m)}, sensor_);
  ASSERT_TRUE(aligned);
  EXPECT_FALSE(std::isfinite(aligned->scale.sigma));
}

TEST_F(AlignViews, OtherPicturesStayDifferent) {
  repaint_middle(250);
  const auto aligned = align(kTravelled_m);
  ASSERT_TRUE(aligned);
  EXPECT_LT(appearance_p_value({a_}, {b_}, aligned->T_reference_camera, world_.camera), 1e-3);
}

TEST_F(AlignViews, SaysNothingWhereDriftDoesNotExplainIt) {
  const PredictedView certain{T_a_b_ * drift_ * drift_, Matrix6d::Zero()};
  EXPECT_FALSE(align_views({a_}, {b_}, certain, sensor_));
}

TEST_F(AlignViews, SaysNothingWhereTooFewKeypointsAgree) {
  repaint_middle(1000);
  EXPECT_FALSE(align(kTravelled_m));
  b_.depths_m.assign(b_.size(), 0);
  EXPECT_FALSE(align(kTravelled_m));
}

}  // namespace
}  // namespace kinloop
