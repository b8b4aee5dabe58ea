#include "kinloop/core/association.hpp"

#include <cstdlib>
#include <set>
#include <tuple>

#include <gmock/gmock.h>

#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAreArray;

constexpr int64_t kMs = 1'000'000;

std::vector<StampPair> associate_ms(std::vector<int64_t> a_ms, std::vector<int64_t> b_ms) {
  for (auto& stamp : a_ms) stamp *= kMs;
  for (auto& stamp : b_ms) stamp *= kMs;
  return associate_stamps(a_ms, b_ms);
}

/// associate.py, verbatim: all close pairs sorted by difference, taken greedily.
std::vector<StampPair> associate_brute_force(const std::vector<int64_t>& a, const std::vector<int64_t>& b) {
  std::set<std::tuple<int64_t, int64_t, int64_t, size_t, size_t>> candidates;
  for (size_t i = 0; i < a.size(); ++i) {
    for (size_t j = 0; j < b.size(); ++j) {
      const int64_t difference = std::abs(a[i] - b[j]);
      if (difference <= kMaxAssociationNs) candidates.insert({difference, a[i], b[j], i, j});
    }
  }
  std::set<size_t> a_left, b_left;
  for (size_t i = 0; i < a.size(); ++i) a_left.insert(i);
  for (size_t j = 0; j < b.size(); ++j) b_left.insert(j);
  std::vector<StampPair> chosen;
  for (const auto& [difference, stamp_a, stamp_b, i, j] : candidates) {
    if (!a_left.contains(i) || !b_left.contains(j)) continue;
    a_left.erase(i);
    b_left.erase(j);
    chosen.push_back({i, j});
  }
  return chosen;
}

TEST(Association, PairsEqualStamps) {
  EXPECT_THAT(associate_ms({0, 33, 66}, {0, 33, 66}),
              ElementsAre(StampPair{0, 0}, StampPair{1, 1}, StampPair{2, 2}));
}

TEST(Association, DefaultToleranceIsTwentyMilliseconds) {
  EXPECT_THAT(associate_stamps(std::vector<int64_t>{0}, std::vector<int64_t>{20 * kMs}),
              ElementsAre(StampPair{0, 0}));
  EXPECT_THAT(associate_stamps(std::vector<int64_t>{0}, std::vector<int64_t>{20 * kMs + 1}), IsEmpty());
}

TEST(Association, TheClosestPairIsTakenFirst) {
  // Taking each a's nearest in order of time would pair 0 with 12 and leave 15 with 29.
  EXPECT_THAT(associate_ms({0, 15}, {12, 29}), ElementsAre(StampPair{1, 0}));
}

TEST(Association, EachEntryIsUsedOnce) {
  EXPECT_THAT(associate_ms({0, 1, 2}, {1}), ElementsAre(StampPair{1, 0}));
  EXPECT_THAT(associate_ms({5}, {1, 2, 6}), ElementsAre(StampPair{0, 2}));
}

TEST(Association, TheResultIsInOrderOfTimeWhateverTheOrderOfTheLists) {
  EXPECT_THAT(associate_ms({66, 0, 33}, {34, 67, 1}),
              ElementsAre(StampPair{1, 2}, StampPair{2, 0}, StampPair{0, 1}));
}

TEST(Association, EmptyListsGiveNoPairs) {
  EXPECT_THAT(associate_ms({}, {1, 2}), IsEmpty());
  EXPECT_THAT(associate_ms({1, 2}, {}), IsEmpty());
}

TEST(Association, NanosecondsOfUnixTimeCount) {
  const int64_t now = 1'305'031'910'765'238'000;
  EXPECT_THAT(associate_stamps(std::vector<int64_t>{now}, std::vector<int64_t>{now - 2, now + 1}),
              ElementsAre(StampPair{0, 1}));
}

TEST(Association, EqualsBruteForceOnRandomLists) {
  Random random(7);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<int64_t> a, b;
    const auto stamp = [&] { return static_cast<int64_t>(random.index(1000)) * kMs; };
    for (int i = 0; i < 40; ++i) a.push_back(stamp());
    for (int i = 0; i < 60; ++i) b.push_back(stamp());
    EXPECT_THAT(associate_stamps(a, b), UnorderedElementsAreArray(associate_brute_force(a, b)));
  }
}

}  // namespace
}  // namespace kinloop
