#include "kinloop/core/quantile.hpp"

#include <gmock/gmock.h>

namespace kinloop {
namespace {

TEST(Quantile, IsTheValueAtThatPlaceOfTheSortedOnes) {
  const std::vector<double> values = {50, 10, 40, 20, 30};
  EXPECT_EQ(quantile(values, 0), 10);
  EXPECT_EQ(quantile(values, 0.25), 20);
  EXPECT_EQ(quantile(values, 0.99), 40);
  EXPECT_EQ(quantile(values, 1), 50);
}

TEST(Quantile, TheMedianOfAnEvenNumberIsTheLargerOfTheMiddleTwo) {
  EXPECT_EQ(median(std::vector<int>{4, 1, 3, 2}), 3);
  EXPECT_EQ(median(std::vector<int>{9, 1, 5}), 5);
}

TEST(Quantile, EmptyInputGivesZero) {
  EXPECT_EQ(median(std::vector<float>{}), 0);
  EXPECT_EQ(quantile(std::vector<float>{}, 0.5), 0);
}

}  // namespace
}  // namespace kinloop
