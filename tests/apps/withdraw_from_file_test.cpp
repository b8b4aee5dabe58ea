#include "apps/map/withdraw_from_file.hpp"

#include <gtest/gtest.h>

#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

TEST(WithdrawnName, IsBesideTheMapAndFree) {
  const test::TempFolder folder;
  const auto name_of = [&](const char* map) {
    return free_withdrawn_name(folder.path() / map).filename().string();
  };
  EXPECT_EQ(free_withdrawn_name(folder.path() / "map.kinmap"), folder.path() / "map_withdrawn.kinmap");
  folder.write("map_withdrawn.kinmap", "");
  EXPECT_EQ(name_of("map.kinmap"), "map_withdrawn_2.kinmap");
  EXPECT_EQ(name_of("map_withdrawn.kinmap"), "map_withdrawn_2.kinmap");
  folder.write("map_withdrawn_2.kinmap", "");
  EXPECT_EQ(name_of("map_withdrawn_2.kinmap"), "map_withdrawn_3.kinmap");
  EXPECT_EQ(name_of("other.kinmap"), "other_withdrawn.kinmap");
}

}  // namespace
}  // namespace kinloop
