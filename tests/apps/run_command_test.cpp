// What kinloop tells the user who gave it the wrong word, camera or ground truth.

#include <gmock/gmock.h>

#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using test::kDone;
using test::kTrackingLost;
using test::kWrongUse;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class RunCommand : public test::ProgramTest {
 protected:
  /// A sequence of a few small frames.
  [[nodiscard]] std::string sequence() const {
    EXPECT_EQ(run("simulate room --frames 4 --size 160x120 -q -o '" + at("seq") + "'").exit_code, kDone);
    return at("seq");
  }
};

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

TEST_F(RunCommand, DepthInTheWrongUnitsIsSaid) {
  const std::string folder = sequence();
  std::string camera = read_file(folder + "/camera.yaml");
  folder_.write("camera.yaml", camera.replace(camera.find("depth_scale: 5000"), 17, "depth_scale: 1"));
  const Run done = run("run '" + folder + "' -q --camera '" + at("camera.yaml") + "' -o '" + at("out") + "'");
  EXPECT_THAT(done.err, AllOf(HasSubstr("only 0.0 % of the depth"), HasSubstr("depth_scale (1 units"),
                              HasSubstr("dense.max_m")));
}

TEST_F(RunCommand, ARunThatNeverBeganSaysSo) {
  const Run lost = run("run '" + sequence() + "' -q --set min_start_points=10000 -o '" + at("out") + "'");
  EXPECT_EQ(lost.exit_code, kTrackingLost);
  EXPECT_THAT(lost.err,
              AllOf(HasSubstr("the map has no point"), HasSubstr("no frame had enough key points")));
}

TEST_F(RunCommand, GroundTruthOfAnotherTimeIsSaid) {
  const std::string folder = sequence();
  folder_.write("seq/groundtruth.txt", "9000 0 0 0 0 0 0 1\n9001 1 0 0 0 0 0 1\n9002 0 1 0 0 0 0 1\n");
  const Run done = run("run '" + folder + "' -q -o '" + at("out") + "'");
  EXPECT_EQ(done.exit_code, kDone) << done.err;
  EXPECT_THAT(done.err, AllOf(HasSubstr("the estimate lasts from 1.0"),
                              HasSubstr("the truth lasts from 9000.000000 to 9002.000000")));
}

}  // namespace
}  // namespace kinloop
