#include "kinloop/loop/appearance_check.hpp"

#include <gtest/gtest.h>

#include "tests/support/synthetic_world.hpp"

namespace kinloop {
namespace {

using test::camera_at;

constexpr double kUnlikely = 1e-3;

/// Two views of one wall in a room of points.
class AppearanceCheck : public testing::Test {
 protected:
  AppearanceCheck() {
    // The check ignores keypoints without depth.
    noise_.missing_depth_fraction = 0;
    a_ = *test::observe(world_, T_world_a_, noise_, 1).features;
    b_ = *test::observe(world_, T_world_b_, noise_, 2).features;
  }

  [[nodiscard]] double chance() const {
    return appearance_p_value(a_, b_, T_world_a_.inverse() * T_world_b_, world_.camera);
  }

  /// Changes the keypoints of `b_` in the window, as if the image differed there.
  template <class Change>
  void in_window(double size_px, const Change& change) {
    const Eigen::Vector2f center(320, 240);
    for (uint32_t i = 0; i < b_.size(); ++i) {
      if ((b_.pixels[i] - center).lpNorm<Eigen::Infinity>() < size_px / 2) change(static_cast<int>(i));
    }
  }

  void repaint(int row, Random& random) {
    for (int byte = 0; byte < kOrbBytes; ++byte) {
      b_.descriptors.at<uint8_t>(row, byte) = static_cast<uint8_t>(random.next());
    }
  }

  test::SyntheticWorld world_ = test::make_world(12000, 1);
  test::ObservationNoise noise_;
  SE3 T_world_a_ = camera_at(0.05, {-0.1, 0, 0}), T_world_b_ = camera_at(-0.05, {0.1, 0, 0.1});
  Features a_, b_;
};

TEST_F(AppearanceCheck, SameSceneHasAHighPValue) {
  ASSERT_GT(a_.size(), 500U);
  EXPECT_GT(chance(), 0.5);
}

TEST_F(AppearanceCheck, DifferentTextureHasALowPValue) {
  Random random(3);
  in_window(250, [&](int row) { repaint(row, random); });
  EXPECT_LT(chance(), kUnlikely);
  std::swap(a_, b_);
  std::swap(T_world_a_, T_world_b_);
  EXPECT_LT(chance(), kUnlikely) << "the other way around";
}

TEST_F(AppearanceCheck, ASmallChangeIsTolerated) {
  Random random(3);
  in_window(80, [&](int row) { repaint(row, random); });
  EXPECT_GT(chance(), kUnlikely);
}

TEST_F(AppearanceCheck, UniformlyLowRepeatabilityIsTolerated) {
  Random random(4);
  for (int row = 0; row < b_.descriptors.rows; ++row) {
    if (random.uniform() < 0.6) repaint(row, random);
  }
  EXPECT_GT(chance(), kUnlikely) << "as with blur";
}

TEST_F(AppearanceCheck, OcclusionIsTolerated) {
  Random random(5);
  in_window(250, [&](int row) {
    repaint(row, random);
    b_.depths_m[static_cast<size_t>(row)] = 0.6F;
  });
  EXPECT_GT(chance(), kUnlikely);
}

TEST_F(AppearanceCheck, TooFewKeypointsGiveAPValueOfOne) {
  EXPECT_EQ(appearance_p_value(a_, {}, {}, world_.camera), 1);
  a_.depths_m.assign(a_.size(), 0);
  b_.depths_m.assign(b_.size(), 0);
  EXPECT_EQ(chance(), 1);
}

}  // namespace
}  // namespace kinloop
