#include <gtest/gtest.h>

#include "session/plan/run_options.hpp"

namespace kinloop {
namespace {

TEST(WorkBudget, GivesTheMostAccurateLevelThatIsAffordable) {
  const auto& levels = work_levels();
  ASSERT_GE(levels.size(), 2U);
  EXPECT_EQ(&work_level(1000), &levels.front());
  for (size_t i = 0; i < levels.size(); ++i) {
    EXPECT_EQ(&work_level(levels[i].percent), &levels[i]);
    if (i == 0) continue;
    EXPECT_LT(levels[i].percent, levels[i - 1].percent);
    EXPECT_EQ(&work_level((levels[i].percent + levels[i - 1].percent) / 2), &levels[i]);
  }
  EXPECT_EQ(&work_level(0.1), &levels.back());
}

TEST(WorkBudget, TheFirstLevelIsThatOfTheDefaults) {
  EXPECT_TRUE(work_levels().front().assignments.empty());
}

TEST(WorkBudget, LevelsAreOptionsOfARun) {
  ASSERT_GE(work_levels().size(), 2U);
  for (const WorkLevel& level : work_levels()) EXPECT_NO_THROW(run_options_with({}, level.assignments));
}

}  // namespace
}  // namespace kinloop
