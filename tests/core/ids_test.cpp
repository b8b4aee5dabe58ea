#include "kinloop/core/ids.hpp"

#include <type_traits>
#include <unordered_set>

#include <gtest/gtest.h>

namespace kinloop {
namespace {

static_assert(!std::is_convertible_v<KeyframeId, LandmarkId>);
static_assert(!std::is_convertible_v<uint32_t, KeyframeId>);
static_assert(!std::is_same_v<KeyframeId, FrameId>);

TEST(Id, DefaultNamesNothing) {
  EXPECT_FALSE(FrameId{}.valid());
  EXPECT_TRUE(FrameId{0}.valid());
}

TEST(Id, OrderIsThatOfTheNumbers) {
  EXPECT_LT(LandmarkId{3}, LandmarkId{4});
  EXPECT_EQ(LandmarkId{3}, LandmarkId{3});
  EXPECT_NE(LandmarkId{3}, LandmarkId{});
}

TEST(Id, CanBeKeptInHashedSets) {
  std::unordered_set<KeyframeId> set = {KeyframeId{1}, KeyframeId{2}, KeyframeId{1}};
  EXPECT_EQ(set.size(), 2U);
  EXPECT_TRUE(set.contains(KeyframeId{2}));
}

}  // namespace
}  // namespace kinloop
