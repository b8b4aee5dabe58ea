#include "kinloop/geometry/robust_loss.hpp"

#include <gtest/gtest.h>

#include "kinloop/sensor/depth_noise.hpp"

namespace kinloop {
namespace {

template <class Loss>
class RobustLoss : public testing::Test {};
using Losses = testing::Types<HuberLoss, CauchyLoss>;
TYPED_TEST_SUITE(RobustLoss, Losses);

TYPED_TEST(RobustLoss, SmallResidualsAreLeftAsTheyAre) {
  const TypeParam loss{2.0};
  EXPECT_EQ(loss.rho(0), 0);
  EXPECT_EQ(loss.weight(0), 1);
  EXPECT_NEAR(loss.rho(1e-6), 1e-6, 1e-12);
}

TYPED_TEST(RobustLoss, WeightIsTheDerivativeOfRho) {
  constexpr double kStep = 1e-5;
  for (const double width : {0.5, 1.0, 2.447}) {
    const TypeParam loss{width};
    for (const double squared : {0.01, 0.1, 0.7, 3.0, 20.0, 1e3}) {
      const double numeric = (loss.rho(squared + kStep) - loss.rho(squared - kStep)) / (2 * kStep);
      EXPECT_NEAR(loss.weight(squared), numeric, 1e-6);
    }
  }
}

TYPED_TEST(RobustLoss, GrowsButEverMoreSlowly) {
  const TypeParam loss{1.5};
  for (double squared = 0; squared < 100; squared += 0.5) {
    EXPECT_GT(loss.rho(squared + 0.5), loss.rho(squared));
    EXPECT_LE(loss.rho(squared), squared);
    EXPECT_LE(loss.weight(squared + 0.5), loss.weight(squared));
    EXPECT_GT(loss.weight(squared), 0);
  }
}

TEST(HuberLoss, IsQuadraticInsideAndLinearOutside) {
  const HuberLoss loss{2.0};
  EXPECT_EQ(loss.rho(4.0), 4.0);
  EXPECT_EQ(loss.rho(3.0), 3.0);
  EXPECT_NEAR(loss.rho(36.0) - loss.rho(25.0), 2 * 2.0 * (6 - 5), 1e-12);
}

TEST(HuberLoss, EfficiencyIsThatOfTheMedianAtOneEndAndOfTheMeanAtTheOther) {
  EXPECT_NEAR(huber_efficiency(0), 2 / std::numbers::pi, 1e-12);
  EXPECT_NEAR(huber_efficiency(1e-3), 2 / std::numbers::pi, 1e-3);
  EXPECT_NEAR(huber_efficiency(1.345), 0.95, 1e-3);  // the textbook value
  EXPECT_NEAR(huber_efficiency(8), 1, 1e-9);
  EXPECT_EQ(huber_efficiency(std::numeric_limits<double>::infinity()), 1);
}

TEST(DepthNoise, GrowsWithTheSquareOfTheDistance) {
  const DepthNoise noise;
  EXPECT_DOUBLE_EQ(noise.sigma_m(1), 1.425e-3);
  EXPECT_DOUBLE_EQ(noise.sigma_m(4), 16 * noise.sigma_m(1));
}

}  // namespace
}  // namespace kinloop
