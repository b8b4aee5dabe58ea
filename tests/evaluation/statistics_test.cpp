#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

TEST(Statistics, OfFourErrorsByHand) {
  const auto s = compute_statistics(std::vector<double>{4, 1, 3, 2});
  EXPECT_EQ(s.count, 4U);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(30.0 / 4));
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(5.0 / 4));  // divided by n, not n - 1
  EXPECT_DOUBLE_EQ(s.min, 1);
  EXPECT_DOUBLE_EQ(s.max, 4);
}

TEST(Statistics, TheMedianOfAnOddNumberIsTheMiddleOne) {
  EXPECT_DOUBLE_EQ(compute_statistics(std::vector<double>{9, 1, 2}).median, 2);
}

TEST(Statistics, EmptyInputGivesZero) {
  const auto s = compute_statistics({});
  EXPECT_EQ(s.count, 0U);
  EXPECT_EQ(s.rmse, 0);
  EXPECT_EQ(s.max, 0);
}

TEST(Statistics, MeanAndDeviationMakeUpTheRmse) {
  const auto s = compute_statistics(std::vector<double>{0.1, 0.7, 0.35, 0.02, 1.4});
  EXPECT_NEAR(s.rmse * s.rmse, s.mean * s.mean + s.std * s.std, 1e-15);
}

}  // namespace
}  // namespace kinloop
