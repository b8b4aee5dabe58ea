#include "kinloop/loop/verification/relative_scale.hpp"

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tests/support/random_map.hpp"

namespace kinloop {
namespace {

constexpr double kSigma_m = 0.01;

/// Points of a room in the frames of two views, the first `scale` times as large; of `outliers` of them the
/// second is anywhere.
std::vector<ScalePair> pairs_of(double scale, const SE3& T_a_b, Random& random, double outliers = 0,
                                int count = 200) {
  std::vector<ScalePair> pairs;
  for (int i = 0; i < count; ++i) {
    const auto point = [&] {
      return Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(1, 4));
    };
    const Eigen::Vector3d b = point();
    const Eigen::Vector3d noise = kSigma_m * test::gaussian_vector<3>(random);
    const Eigen::Vector3d a = scale * (T_a_b.R() * b) + T_a_b.translation + noise;
    pairs.push_back({a, random.uniform() < outliers ? point() : b, kSigma_m});
  }
  return pairs;
}

TEST(RelativeScale, IsFoundWhateverTheMotion) {
  Random random(1);
  for (const double scale : {0.85, 0.97, 1.0, 1.05}) {
    const SE3 T_a_b = test::random_step(random, 1, 0.5);
    const RelativeScale found = estimate_scale(pairs_of(scale, T_a_b, random), T_a_b.R());
    EXPECT_NEAR(found.factor, scale, 0.006);
    EXPECT_LT(found.sigma, 0.004);
  }
}

TEST(RelativeScale, AThirdMayBeFalseMatches) {
  Random random(2);
  const SE3 T_a_b = test::random_step(random, 1, 0.5);
  const RelativeScale found = estimate_scale(pairs_of(0.93, T_a_b, random, 0.3), T_a_b.R());
  EXPECT_NEAR(found.factor, 0.93, 0.02);
  EXPECT_TRUE(contradicts_same_place(found));
}

TEST(RelativeScale, ErrorsAreThoseThatItsSigmaTells) {
  Random random(3);
  const SE3 T_a_b = test::random_step(random, 1, 0.5);
  constexpr int kTrials = 100;
  int beyond = 0;
  for (int i = 0; i < kTrials; ++i) {
    const RelativeScale found = estimate_scale(pairs_of(1, T_a_b, random, 0, 40), T_a_b.R());
    beyond += std::abs(found.factor - 1) > 2 * found.sigma ? 1 : 0;
    EXPECT_FALSE(contradicts_same_place(found));
  }
  EXPECT_LT(beyond, 12);  // of 100, 5 are expected
}

TEST(RelativeScale, FewPointsTellNothing) {
  Random random(4);
  const auto pairs = pairs_of(0.5, SE3{}, random, 0, kMinScalePairs - 1);
  EXPECT_FALSE(contradicts_same_place(estimate_scale(pairs, Eigen::Matrix3d::Identity())));
}

TEST(RelativeScale, IndependentMeasurementsAreCombinedByTheirVariances) {
  const std::vector<RelativeScale> scales = {{0.98, 0.01}, {1.02, 0.01}, {5, 1e9}, {}};
  const RelativeScale combined = combine(scales);
  EXPECT_NEAR(combined.factor, 1, 1e-9);
  EXPECT_NEAR(combined.sigma, 0.01 / std::sqrt(2), 1e-9);
  EXPECT_FALSE(contradicts_same_place(combine({})));
}

TEST(RelativeScale, TwoPerCentAndThreeSigmaRefute) {
  EXPECT_TRUE(contradicts_same_place({0.975, 0.004}));
  EXPECT_TRUE(contradicts_same_place({1.025, 0.004}));
  EXPECT_FALSE(contradicts_same_place({0.985, 0.001}));
  EXPECT_FALSE(contradicts_same_place({0.95, 0.02}));
}

}  // namespace
}  // namespace kinloop
