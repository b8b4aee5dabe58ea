// The report, end to end: its title, and its pictures of loops.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kDone;
using testing::HasSubstr;
using testing::Not;

class ReportCommand : public test::ProgramTest {
 protected:
  void SetUp() override {
    ASSERT_EQ(run("simulate room --frames 8 --size 160x120 -q -o '" + at("data/walk") + "'").exit_code,
              kDone);
    ASSERT_EQ(run("run '" + at("data/walk") + "/' -q -o '" + at("out") + "'").exit_code, kDone);
  }

  /// The figures of the first run on the page.
  [[nodiscard]] nlohmann::json shown(const std::string& page) const {
    const std::string text = read_file(at(page)), begin = R"(id="data">)";
    const size_t from = text.find(begin) + begin.size();
    return nlohmann::json::parse(text.substr(from, text.find("</script>", from) - from)).at("runs");
  }
};

TEST_F(ReportCommand, IsCalledByTheNameOfTheSequence) {
  EXPECT_EQ(shown("out/report.html")[0]["name"], "walk");
  ASSERT_EQ(shell("cd '" + at("data/walk") + "' && '" KINLOOP_PROGRAM "' run . -q -o '" + at("here") + "'")
                .exit_code,
            kDone);
  EXPECT_EQ(shown("here/report.html")[0]["name"], "walk") << "independent of the working directory";
}

TEST_F(ReportCommand, RunsAreLabelledByTheirFolders) {
  ASSERT_EQ(shell("cp -r '" + at("out") + "' '" + at("data/out") + "'").exit_code, kDone);
  const Run done = run("report '" + at("out") + "' '" + at("data/out") + "' '" + at("out/trajectory.txt") +
                       "' -o '" + at("both.html") + "'");
  ASSERT_EQ(done.exit_code, kDone) << done.err;
  const auto runs = shown("both.html");
  EXPECT_EQ(runs[0]["name"], folder_.path().filename().string() + "/out");
  EXPECT_EQ(runs[1]["name"], "data/out");
  EXPECT_EQ(runs[2]["name"], "out/trajectory.txt");
}

TEST_F(ReportCommand, PicturesOfLoopsHaveTheirFigures) {
  folder_.write("out/loops/1.000000_1.200000.jpg", "\xff\xd8 a picture");
  folder_.write("out/loops/loops.json", R"([{"file": "1.000000_1.200000.jpg", "stamp_a": "1.000000",
    "stamp_b": "1.200000", "reprojected": 300, "observed": 200, "median_error_px": 0.817, "distance_m": 0.421,
    "angle_deg": 12.34, "inliers": 77}, {"file": "gone.jpg", "stamp_a": "1", "stamp_b": "2", "reprojected": 1,
    "observed": 0, "median_error_px": 0, "distance_m": 0, "angle_deg": 0, "inliers": 0}])");
  ASSERT_EQ(run("report '" + at("out") + "'").exit_code, kDone);
  const auto pictures = shown("out/report.html")[0]["loopPictures"];
  ASSERT_EQ(pictures.size(), 1U) << "missing pictures are left out";
  EXPECT_EQ(pictures[0]["caption"],
            "0.0 s (left) and 0.2 s (right), cameras 0.42 m and 12.3\u00b0 apart. 300 landmarks reprojected, "
            "200 of "
            "them observed in both images, median error 0.82 px. Loop closure: 77 inliers.");
}

TEST_F(ReportCommand, IncludesNoFilesFromOutsideTheFolder) {
  folder_.write("secret.jpg", "secret");
  folder_.write("out/loops/loops.json", R"([{"file": "../../secret.jpg", "stamp_a": "1", "stamp_b": "2",
    "reprojected": 1, "observed": 0, "median_error_px": 0, "distance_m": 0, "angle_deg": 0, "inliers": 0}])");
  ASSERT_EQ(run("report '" + at("out") + "'").exit_code, kDone);
  EXPECT_EQ(shown("out/report.html")[0]["loopPictures"].size(), 0U);
}

TEST_F(ReportCommand, ADamagedIndexIsNamed) {
  folder_.write("out/loops/loops.json", "[{\"file\": 3}]");
  const Run done = run("report '" + at("out") + "'");
  EXPECT_EQ(done.exit_code, kBadInput);
  EXPECT_THAT(done.err, HasSubstr("loops.json"));
  EXPECT_THAT(done.err, Not(HasSubstr("terminate")));
}

}  // namespace
}  // namespace kinloop
