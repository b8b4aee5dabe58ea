// --viewer and kinloop view, end to end.

#include <algorithm>

#include <gmock/gmock.h>

#include "tests/apps/program_test.hpp"

namespace kinloop::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ViewCommandTest : public ProgramTest {
 protected:
  /// A run on a few small frames; `arguments` give the sequence.
  [[nodiscard]] Run short_run(const std::string& arguments) const {
    return run("run " + arguments + " -o '" + at("out") +
               "' --set sim.frames=4 --set sim.width=160 --set sim.height=120");
  }

  /// `kinloop view`, interrupted after a while.
  [[nodiscard]] Run view(const std::string& arguments) const {
    return run("view " + arguments, "timeout --preserve-status -s INT 3");
  }
};

TEST_F(ViewCommandTest, ViewerPortMayBeASeparateArgument) {
  for (const char* arguments : {"--viewer 0 sim:room", "sim:room --viewer 0", "--viewer=0 sim:room",
                                "--viewer 127.0.0.1:0 sim:room", "sim:room --viewer localhost:0"}) {
    EXPECT_THAT(short_run(arguments).err, HasSubstr("viewer at http://127.0.0.1:")) << arguments;
  }
}

TEST_F(ViewCommandTest, NonPortArgumentIsTheSequence) {
  for (const char* arguments : {"--viewer sim:room:7", "--viewer -q no_such_folder", "--viewer no/such:7"}) {
    const Run done = short_run(arguments);
    EXPECT_THAT(done.err, Not(HasSubstr("expected PORT"))) << arguments;
    EXPECT_NE(done.exit_code, kWrongUse) << arguments << "\n" << done.err;
  }
}

TEST_F(ViewCommandTest, InvalidPortIsAUsageError) {
  for (const char* arguments :
       {"sim:room --viewer 99999", "sim:room --viewer=abc", "sim:room --viewer myhost:80"}) {
    const Run done = short_run(arguments);
    EXPECT_EQ(done.exit_code, kWrongUse) << arguments << "\n" << done.err;
  }
}

TEST_F(ViewCommandTest, ADamagedFileIsOneLineAndNoBrowser) {
  folder_.write("bad.ply",
                "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
                "property float z\nend_header\n1 2 3\n");
  folder_.write("bad.pcd", "nothing of the kind");
  folder_.write("bad.glb", "glTF");
  folder_.write("notes.txt", "text");
  for (const char* name : {"bad.ply", "bad.pcd", "bad.glb", "notes.txt", "missing.ply"}) {
    const Run done = view("--port 0 '" + at(name) + "'");
    EXPECT_EQ(done.exit_code, kBadInput) << name;
    EXPECT_THAT(done.err, AllOf(HasSubstr(name), Not(HasSubstr("http://")))) << name;
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
  }
}

TEST_F(ViewCommandTest, AcceptsTheSamePortSyntax) {
  const auto file =
      folder_.write("good.ply",
                    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                    "property float z\nend_header\n1 2 3\n");
  for (const std::string option : {"--port 0", "--viewer 0", "--viewer=127.0.0.1:0"}) {
    EXPECT_THAT(view(option + (" '" + file.string() + "'")).err, HasSubstr("viewer at http://127.0.0.1:"))
        << option;
  }
}

}  // namespace
}  // namespace kinloop::test
