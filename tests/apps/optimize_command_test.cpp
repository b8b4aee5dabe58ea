// kinloop optimize, end to end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "kinloop/core/stopwatch.hpp"
#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;

constexpr const char* kStep = " 1 0 0 10 0 0 10 0 10\n";

using test::kBadInput;
using test::kWrongUse;

std::string vertex(int id, double x) {
  return "VERTEX_SE2 " + std::to_string(id) + " " + std::to_string(x) + " 0 0\n";
}

std::string edge(int a, int b) {
  return "EDGE_SE2 " + std::to_string(a) + " " + std::to_string(b) + kStep;
}

class OptimizeCommand : public test::ProgramTest {
 protected:
  /// `arguments` follow "kinloop optimize".
  [[nodiscard]] Run run(const std::string& arguments) const {
    return ProgramTest::run("optimize " + arguments);
  }

  /// Names of the files in the folder, without those of stdout and stderr.
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename().string();
      if (name != "stdout" && name != "stderr") names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return names;
  }
};

TEST_F(OptimizeCommand, WritesGraphFiguresAndPicture) {
  const auto input =
      folder_.write("in.g2o", vertex(0, 0) + vertex(1, 5) + vertex(2, 1) + edge(0, 1) + edge(1, 2));
  const Stopwatch whole;
  const Run solved = run(input.string() + " -o " + at("out.g2o") + " --report " + at("out.html") + " --json");
  const double whole_s = whole.wall_s();
  ASSERT_EQ(solved.exit_code, 0) << solved.err;
  const auto figures = nlohmann::json::parse(solved.out);
  EXPECT_NEAR(figures.at("chi2_before").get<double>(), 10 * (4 * 4 + 5 * 5), 1e-9);
  EXPECT_NEAR(figures.at("chi2_after").get<double>(), 0, 1e-9);
  EXPECT_GT(figures.at("iterations").get<int>(), 0);
  EXPECT_GT(figures.at("seconds").get<double>(), 0);
  EXPECT_LT(figures.at("seconds").get<double>(), whole_s);  // solving is a part of it
  EXPECT_THAT(read_file(at("out.g2o")), HasSubstr("VERTEX_SE2 2 "));
  EXPECT_THAT(read_file(at("out.html")), HasSubstr("<svg"));
}

TEST_F(OptimizeCommand, ChainsPosesWhereTheFileHasNone) {
  const auto input = folder_.write("in.g2o", edge(0, 1) + edge(1, 2));
  const Run solved = run(input.string() + " -o " + at("out.g2o"));
  EXPECT_EQ(solved.exit_code, 0);
  EXPECT_THAT(solved.err, HasSubstr("spanning tree"));
  EXPECT_THAT(read_file(at("out.g2o")), HasSubstr("VERTEX_SE2 2 2 0 0\n"));
}

TEST_F(OptimizeCommand, SaysThatAGraphFallsApartAndSolvesEachPart) {
  const auto input = folder_.write(
      "in.g2o", vertex(0, 0) + vertex(1, 3) + vertex(5, 10) + vertex(6, 20) + edge(0, 1) + edge(5, 6));
  const Run solved = run(input.string() + " -o " + at("out.g2o") + " --json");
  EXPECT_EQ(solved.exit_code, 0);
  EXPECT_THAT(solved.err, HasSubstr("2 disconnected parts"));
  EXPECT_EQ(nlohmann::json::parse(solved.out).at("parts"), 2);
  EXPECT_THAT(read_file(at("out.g2o")), HasSubstr("VERTEX_SE2 1 1 0 0\n"));
  EXPECT_THAT(read_file(at("out.g2o")), HasSubstr("VERTEX_SE2 6 11 0 0\n"));
}

TEST_F(OptimizeCommand, CountsInformationThatIsNotPositive) {
  const auto input =
      folder_.write("in.g2o", vertex(0, 0) + vertex(1, 3) + "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 5\n" + edge(0, 1));
  const Run solved = run(input.string() + " -o " + at("out.g2o") + " --json");
  EXPECT_EQ(solved.exit_code, 0);
  EXPECT_THAT(solved.err, HasSubstr("in.g2o:3"));
  EXPECT_EQ(nlohmann::json::parse(solved.out).at("repaired_edges"), 1);
}

TEST_F(OptimizeCommand, NamesFileAndLineOfBadInputAndWritesNothing) {
  const struct {
    const char* what;
    std::string text;
    const char* place;
  } cases[] = {
      {"missing vertex", vertex(0, 0) + edge(0, 1), "in.g2o:2:"},
      {"duplicate id", vertex(0, 0) + vertex(0, 1) + edge(0, 1), "in.g2o:2:"},
      {"not a number", vertex(0, 0) + "VERTEX_SE2 1 nan 0 0\n" + edge(0, 1), "in.g2o:2:"},
      {"truncated", vertex(0, 0) + vertex(1, 1) + "EDGE_SE2 0 1 1 0", "in.g2o:3:"},
      {"empty", "", "in.g2o"},
  };
  for (const auto& bad : cases) {
    const auto input = folder_.write("in.g2o", bad.text);
    const Run failed = run(input.string() + " -o " + at("out.g2o") + " --report " + at("out.html"));
    EXPECT_EQ(failed.exit_code, kBadInput) << bad.what;
    EXPECT_THAT(failed.err, HasSubstr(bad.place)) << bad.what;
    EXPECT_THAT(files(), testing::ElementsAre("in.g2o")) << bad.what;
    EXPECT_EQ(read_file(input), bad.text);
  }
}

TEST_F(OptimizeCommand, DoesNotWriteOverItsInputUnlessTold) {
  const std::string text = vertex(0, 0) + vertex(1, 5) + edge(0, 1);
  const auto input = folder_.write("in.g2o", text).string();
  const Run refused = run(input + " -o " + input);
  EXPECT_EQ(refused.exit_code, kWrongUse);
  EXPECT_THAT(refused.err, HasSubstr("--overwrite"));
  EXPECT_EQ(run(input + " -o " + at("out.g2o") + " --overwrite --report " + input).exit_code, kWrongUse);
  EXPECT_EQ(read_file(input), text);
  EXPECT_EQ(run(input + " -o " + input + " --overwrite").exit_code, 0);
  EXPECT_NE(read_file(input), text);
}

TEST_F(OptimizeCommand, NoticesBeforeSolvingThatItCannotWrite) {
  const auto input = folder_.write("in.g2o", "this line would be an error, were it read\n").string();
  for (const std::string& output : {at("in.g2o/out.g2o"), folder_.path().string()}) {
    const Run failed = run(input + " -o " + output);
    EXPECT_EQ(failed.exit_code, kBadInput);
    EXPECT_THAT(failed.err,
                HasSubstr(std::filesystem::path(output).filename() == "out.g2o" ? input : output));
    EXPECT_THAT(failed.err, testing::Not(HasSubstr("in.g2o:1")));
  }
  EXPECT_EQ(run(input + " -o " + at("one") + " --report " + at("one")).exit_code, kWrongUse);
  EXPECT_THAT(files(), testing::ElementsAre("in.g2o"));
}

}  // namespace
}  // namespace kinloop
