// What kinloop tells the user who gave it the wrong word.

#include <gmock/gmock.h>

#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using test::kWrongUse;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using RunCommand = test::ProgramTest;

TEST_F(RunCommand, UnknownCommandsAreNamedWithTheNearest) {
  const Run far = run("frobnicate");
  EXPECT_EQ(far.exit_code, kWrongUse);
  EXPECT_THAT(far.err, AllOf(HasSubstr("'frobnicate'"), Not(HasSubstr("did you mean"))));
  EXPECT_THAT(run("simulte room").err, HasSubstr("did you mean 'simulate'?"));
  EXPECT_THAT(run("map inof x").err, HasSubstr("map knows no command 'inof'; did you mean 'info'?"));
}

TEST_F(RunCommand, ASetTakesOneOption) {
  EXPECT_THAT(run("run --help").out, HasSubstr("--set KEY=VALUE "));
  const Run two = run("run sim:room --set sim.frames=2 sim.fps=5");
  EXPECT_EQ(two.exit_code, kWrongUse);
  EXPECT_THAT(two.err, HasSubstr("sim.fps=5"));
}

}  // namespace
}  // namespace kinloop
