// kinloop plan: what it refuses. What it draws is tested in tests/floor_plan.

#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>

#include "tests/apps/program_test.hpp"

namespace kinloop::test {
namespace {

using testing::HasSubstr;

class PlanCommandTest : public ProgramTest {
 protected:
  [[nodiscard]] Run plan(const std::string& map, const std::string& options) const {
    return run("plan '" + at(map) + "' " + options);
  }
};

TEST_F(PlanCommandTest, RefusesOtherFormatsBeforeItReadsTheMap) {
  folder_.write("bad.kinmap", "nothing of the kind");
  for (const char* name : {"plan.dxf", "plan", "plan.svg.gz"}) {
    const Run done = plan("bad.kinmap", "-o '" + at(name) + "'");
    EXPECT_EQ(done.exit_code, kWrongUse) << name;
    EXPECT_THAT(done.err, HasSubstr("the name must end in .svg, .pdf, .png or .json"));
  }
  const Run second = plan("bad.kinmap", "-o '" + at("a.svg") + "' -o '" + at("b.txt") + "'");
  EXPECT_EQ(second.exit_code, kWrongUse);
  EXPECT_FALSE(std::filesystem::exists(at("a.svg")));
  EXPECT_EQ(plan("bad.kinmap", "--dpi 10000").exit_code, kWrongUse);
}

TEST_F(PlanCommandTest, DamagedMapsAreOneLineAndLeaveAnEarlierPlan) {
  folder_.write("bad.kinmap", "nothing of the kind");
  folder_.write("plan.svg", "earlier");
  for (const char* map : {"bad.kinmap", "missing.kinmap"}) {
    const Run done = plan(map, "-o '" + at("plan.svg") + "'");
    EXPECT_EQ(done.exit_code, kBadInput) << map;
    EXPECT_THAT(done.err, HasSubstr(map));
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
  }
  EXPECT_EQ(read_file(at("plan.svg")), "earlier");
}

}  // namespace
}  // namespace kinloop::test
