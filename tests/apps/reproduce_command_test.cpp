// kinloop reproduce: the page of the paper's tables and figures.

#include <filesystem>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kDone;
using testing::AllOf;
using testing::HasSubstr;

using Reproduce = test::ProgramTest;

TEST_F(Reproduce, WritesTablesPicturesAndTheCommandsThatMadeThem) {
  const std::string sequence = at("it's a room");
  ASSERT_EQ(run("simulate room --frames 40 --size 160x120 -q -o \"" + sequence + "\"").exit_code, kDone);
  const Run made =
      run("reproduce \"" + sequence + "\" --images \"" + sequence + "\" -o '" + at("made") + "'");
  ASSERT_EQ(made.exit_code, kDone) << made.err;
  const std::string page = read_file(at("made/reproduced.md"));
  EXPECT_THAT(page, AllOf(HasSubstr("| SIFT (OpenCV) | 983 | 0.6441 |"), HasSubstr("| with loops | "),
                          HasSubstr("| greedy k-means++ | "), HasSubstr("| fx | "),
                          HasSubstr("room' -q -o " + at("made/without_loops") + " --no-loop")));
  const auto figures = nlohmann::json::parse(read_file(at("made/figures.json")));
  EXPECT_EQ(figures.size(), 4U);
  for (const char* file :
       {"trajectories.svg", "comparison.html", "with_loops/report.html", "stills/00.png"}) {
    EXPECT_TRUE(std::filesystem::exists(at("made/") + file)) << file;
  }
  // The drawn stills are of a known camera.
  const auto fx = figures.at("Calibration").at("drawn").at("parameters").at("fx");
  EXPECT_NEAR(fx.at("value").get<double>(), 532, 5 * fx.at("deviation").get<double>());
}

TEST_F(Reproduce, NamesTheCommandThatFailed) {
  const Run failed = run("reproduce '" + at("nowhere") + "' -o '" + at("made") + "'");
  EXPECT_EQ(failed.exit_code, kBadInput);
  EXPECT_THAT(failed.err, AllOf(HasSubstr("no such folder"), HasSubstr("kinloop features ")));
}

}  // namespace
}  // namespace kinloop
