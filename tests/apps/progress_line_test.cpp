#include <gmock/gmock.h>

#include "apps/shared/terminal/progress_bar.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

constexpr size_t kColumns = 79;  // of a terminal of 80

ProgressReport mapping(size_t done, size_t total, const std::string& note = "") {
  return {.stage = "mapping", .done = done, .total = total, .note = note};
}

TEST(ProgressLine, HasABarThatGrows) {
  EXPECT_EQ(progress_line(mapping(0, 4), {}, 60), "mapping    [>                   ]  0/4         ");
  EXPECT_THAT(progress_line(mapping(2, 4), {2, 0}, 60),
              AllOf(HasSubstr("[==========>         ]"), EndsWith("   2 s left")));
  EXPECT_THAT(progress_line(mapping(4, 4), {3, 0}, 60),
              AllOf(HasSubstr("[====================]"), EndsWith("   3 s total")));
}

TEST(ProgressLine, TheBarGivesWayToTheNote) {
  const std::string note = "tracking, 136 keyframes, 12 loops";
  for (const size_t total : {60U, 600U, 1000U}) {
    const std::string line = progress_line(mapping(total / 2, total, note), {10, 0}, kColumns);
    EXPECT_THAT(line, EndsWith(note));
    EXPECT_LE(line.size(), kColumns);
  }
  EXPECT_THAT(progress_line(mapping(500, 1000, note), {10, 0}, kColumns), Not(HasSubstr("[")));
  EXPECT_THAT(progress_line(mapping(500, 1000, note), {10, 0}, kColumns + 20), HasSubstr("[====="));
}

TEST(ProgressLine, ThatIsTooLongIsCut) {
  EXPECT_EQ(progress_line(mapping(1, 2, "note"), {1, 0}, 20), "mapping      1/2    ");
}

TEST(ProgressLine, WithoutATotalHasNoBar) {
  EXPECT_EQ(progress_line(mapping(30, 0, "tracking"), {2, 0}, kColumns),
            "mapping    30    15.0/s   tracking");
}

TEST(ProgressLine, TheTimeLeftIsThatOfTheRestAtTheRateOfThisStage) {
  EXPECT_THAT(progress_line(mapping(60, 100), {10, 40}, kColumns),
              AllOf(HasSubstr("2.0/s"), EndsWith("   20 s left")));
}

}  // namespace
}  // namespace kinloop
