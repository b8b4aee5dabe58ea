// A new user's first steps: help, the version, a nonexistent output folder.

#include <sstream>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "tests/apps/program_test.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using test::kDone;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class GettingStarted : public test::ProgramTest {
 protected:
  /// The folder of a run on a few small frames, in folders that did not exist before.
  [[nodiscard]] std::string ran() const {
    EXPECT_EQ(run("simulate room --frames 4 --size 160x120 -q -o '" + at("new/a/seq") + "'").exit_code,
              kDone);
    EXPECT_EQ(run("run '" + at("new/a/seq") + "' -q -o '" + at("new/b/out") + "'").exit_code, kDone);
    return at("new/b/out");
  }
};

TEST_F(GettingStarted, PlainProgramPrintsQuickStart) {
  const Run alone = run("");
  EXPECT_EQ(alone.exit_code, kDone);
  EXPECT_THAT(alone.out, AllOf(HasSubstr("kinloop run sim:room -o out"), HasSubstr("kinloop view"),
                               HasSubstr("kinloop help COMMAND")));
}

TEST_F(GettingStarted, HelpIsTheSameInBothOrders) {
  EXPECT_EQ(run("help run").out, run("run --help").out);
  EXPECT_EQ(run("help map merge").out, run("map merge --help").out);
  EXPECT_EQ(run("help").out, run("--help").out);
  EXPECT_THAT(run("help mesh").out, HasSubstr("--voxel"));
  EXPECT_EQ(run("version").out, run("--version").out);
}

/// The lines of --version after the first, as name and state.
std::vector<std::pair<std::string, std::string>> parts_of(const std::string& version) {
  std::vector<std::pair<std::string, std::string>> parts;
  std::istringstream lines(version);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    const size_t colon = line.find(": ");
    if (colon == std::string::npos) continue;
    parts.emplace_back(line.substr(0, colon), line.substr(colon + 2));
  }
  return parts;
}

TEST_F(GettingStarted, MissingPartsSayWhatAddsThem) {
  const auto parts = parts_of(run("--version").out);
  EXPECT_GT(parts.size(), 10U);
  const std::string script = read_file(test::source_folder() / "scripts/install_dependencies.sh");
  for (const auto& [name, state] : parts) {
    EXPECT_THAT(state,
                testing::AnyOf("yes", testing::MatchesRegex("no \\(.+; to add it: .+, and build again\\)")))
        << name;
    const bool no_distribution_has_it =
        name == "Kinect 2" || name == "RealSense" || name == "Orbbec" || name == "OAK";
    if (no_distribution_has_it) continue;
    EXPECT_THAT(script, HasSubstr("\"" + name + ": "));
  }
}

TEST_F(GettingStarted, NeedsNoFolderForTemporaryFiles) {
  for (const char* command : {"version", "help vocab train"})
    EXPECT_EQ(run(command, "TMPDIR=/nonexistent").exit_code, kDone) << command;
}

TEST_F(GettingStarted, HelpMentionsNoInternalFiles) {
  for (const char* command : {"run", "eval", "features", "calibrate", "export", "simulate", "record"}) {
    EXPECT_THAT(run(std::string("help ") + command).out, Not(HasSubstr("shared/data"))) << command;
  }
}

TEST_F(GettingStarted, CreatesOutputFolders) {
  const std::string out = ran();
  const std::vector<std::pair<std::string, std::string>> outputs = {
      {"export '" + out + "' --cloud", "c/1/cloud.ply"},
      {"mesh '" + out + "' -o", "c/2/mesh.ply"},
      {"map merge -q '" + out + "' '" + out + "' -o", "c/3/both.kinmap"},
      {"report '" + out + "' '" + out + "' -o", "c/4/both.html"},
      {"optimize '" + out + "/graph.g2o' -o", "c/5/graph.g2o"},
      {"vocab export default -o", "c/6/words.txt"},
      {"record '" + at("new/a/seq") + "' -o", "c/7/seq"},
  };
  for (const auto& [command, output] : outputs) {
    const Run made = run(command + " '" + at(output) + "'");
    EXPECT_EQ(made.exit_code, kDone) << command << made.err;
    EXPECT_TRUE(std::filesystem::exists(at(output))) << command;
  }
}

TEST_F(GettingStarted, VerboseLogsMore) {
  const std::string out = ran();
  const Run verbose = run("run '" + at("new/a/seq") + "' -v -o '" + at("v") + "'");
  EXPECT_THAT(verbose.err, AllOf(HasSubstr("4 frames"), HasSubstr("160 x 120"), HasSubstr("frame 0 "),
                                 HasSubstr("keyframe 0 "), HasSubstr("fusing")));
}

}  // namespace
}  // namespace kinloop
