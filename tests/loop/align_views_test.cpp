#include "kinloop/loop/align_views.hpp"

#include <gtest/gtest.h>

#include "kinloop/features/hamming.hpp"
#include "kinloop/loop/view_checks.hpp"
#include "tests/support/random_vectors.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

using test::camera_at;

/// Two views of a room of points, and their relative pose as drift has left it.
class AlignViews : public testing::Test {
 protected:
  AlignViews() {
    noise_.missing_depth_fraction = 0;
    a_ = *test::observe(world_, T_world_a_, noise_, 1).features;
    b_ = *test::observe(world_, T_world_b_, noise_, 2).features;
  }

  [[nodiscard]] std::optional<SE3> align(const DriftBound& bound) const {
    return align_views(a_, b_, {T_a_b_ * drift_, bound}, sensor_);
  }

  /// Changes the pictures in the middle of the second view.
  void repaint_middle(float size_px) {
    Random random(3);
    for (uint32_t i = 0; i < b_.size(); ++i) {
      if ((b_.pixels[i] - Eigen::Vector2f(320, 240)).lpNorm<Eigen::Infinity>() > size_px / 2) continue;
      for (int byte = 0; byte < b_.descriptors.cols; ++byte)
        b_.descriptors.at<uint8_t>(static_cast<int>(i), byte) = static_cast<uint8_t>(random.next());
    }
  }

  const test::SyntheticWorld world_ = test::make_world(12000, 1);
  test::ObservationNoise noise_;
  const Sensor sensor_{world_.camera};
  const SE3 T_world_a_ = camera_at(0.05, {-0.1, 0, 0}), T_world_b_ = camera_at(-0.05, {0.1, 0, 0.1});
  const SE3 T_a_b_ = T_world_a_.inverse() * T_world_b_;
  const SE3 drift_ = camera_at(0.015, {0.06, -0.04, 0.03});
  Features a_, b_;
};

constexpr DriftBound kBound{0.12, 0.03};

TEST_F(AlignViews, TakesDriftBack) {
  const auto aligned = align(kBound);
  ASSERT_TRUE(aligned);
  const SE3 error = T_a_b_.inverse() * *aligned;
  EXPECT_LT(error.translation.norm(), 0.01);
  EXPECT_LT(error.angle_rad(), 0.003);
}

TEST_F(AlignViews, OtherPicturesStayDifferent) {
  repaint_middle(250);
  const auto aligned = align(kBound);
  ASSERT_TRUE(aligned);
  EXPECT_LT(appearance_p_value({a_}, {b_}, *aligned, world_.camera), 1e-3);
}

TEST_F(AlignViews, SaysNothingWhereDriftDoesNotExplainIt) {
  EXPECT_FALSE(align({0.05, 0.03}));
}

TEST_F(AlignViews, SaysNothingWhereTooFewKeypointsAgree) {
  repaint_middle(1000);
  EXPECT_FALSE(align(kBound));
  b_.depths_m.assign(b_.size(), 0);
  EXPECT_FALSE(align(kBound));
}

}  // namespace
}  // namespace kinloop
