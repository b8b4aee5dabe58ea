#include "kinloop/core/random.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

namespace kinloop {
namespace {

constexpr int kDraws = 100000;

TEST(Random, SameSeedSameNumbersOtherSeedOthers) {
  Random a(5), b(5), c(6);
  int equal_to_c = 0;
  for (int i = 0; i < 100; ++i) {
    const uint64_t value = a.next();
    EXPECT_EQ(value, b.next());
    equal_to_c += value == c.next() ? 1 : 0;
  }
  EXPECT_EQ(equal_to_c, 0);
}

TEST(Random, HashTellsNeighboursApart) {
  std::set<uint64_t> seen;
  for (uint64_t a = 0; a < 100; ++a) {
    for (uint64_t b = 0; b < 100; ++b) seen.insert(hash(a, b));
  }
  EXPECT_EQ(seen.size(), 10000U);
}

TEST(Random, UniformHasItsMeanVarianceAndBounds) {
  Random random(1);
  double sum = 0, squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.uniform(-1, 3);
    ASSERT_GE(x, -1);
    ASSERT_LT(x, 3);
    sum += x;
    squares += x * x;
  }
  const double mean = sum / kDraws;
  EXPECT_NEAR(mean, 1.0, 0.02);
  EXPECT_NEAR(squares / kDraws - mean * mean, 16.0 / 12, 0.03);
}

TEST(Random, GaussianHasItsMomentsAndTails) {
  Random random(2);
  double sum = 0, squares = 0;
  int beyond_two = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.gaussian();
    ASSERT_TRUE(std::isfinite(x));
    sum += x;
    squares += x * x;
    beyond_two += std::abs(x) > 2 ? 1 : 0;
  }
  EXPECT_NEAR(sum / kDraws, 0, 0.015);
  EXPECT_NEAR(squares / kDraws, 1, 0.02);
  EXPECT_NEAR(static_cast<double>(beyond_two) / kDraws, 0.0455, 0.003);
}

TEST(Random, IndexIsEven) {
  Random random(3);
  std::vector<int> counts(10, 0);
  for (int i = 0; i < kDraws; ++i) ++counts.at(random.index(10));
  for (const int count : counts) EXPECT_NEAR(count, kDraws / 10, 400);
}

TEST(Random, IndexBelowOneIsZero) {
  Random random(3);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(random.index(1), 0U);
}

TEST(Sample, GivesDifferentIndicesAndReachesAll) {
  Random random(4);
  std::set<uint32_t> reached;
  for (int i = 0; i < 200; ++i) {
    const auto chosen = sample_without_replacement(random, 10, 4);
    EXPECT_EQ(std::set<uint32_t>(chosen.begin(), chosen.end()).size(), 4U);
    reached.insert(chosen.begin(), chosen.end());
  }
  EXPECT_EQ(reached.size(), 10U);
  EXPECT_EQ(*reached.rbegin(), 9U);
}

TEST(Sample, OfEverythingIsAPermutation) {
  Random random(4);
  auto chosen = sample_without_replacement(random, 5, 5);
  std::sort(chosen.begin(), chosen.end());
  EXPECT_EQ(chosen, (std::vector<uint32_t>{0, 1, 2, 3, 4}));
}

TEST(Sample, TooLargeSizeThrows) {
  Random random(4);
  EXPECT_THROW(sample_without_replacement(random, 3, 4), std::logic_error);
}

}  // namespace
}  // namespace kinloop
