// The report, end to end: its title, and its pictures of loops.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "kinloop/sensor/images/jpeg_codec.hpp"
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
    test::write_room(at("data/walk"), "--frames 8");
    ASSERT_EQ(run("run '" + at("data/walk") + "/' -q -o '" + at("out") + "'").exit_code, kDone);
  }

  static std::string jpeg() {
    const auto bytes = encode_jpeg(cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(0)), 50);
    return {bytes.begin(), bytes.end()};
  }

  /// An index of one picture.
  static std::string index_of(const std::string& file, const std::string& inliers = "0") {
    return R"([{"stamp_a": "1", "stamp_b": "2", "reprojected": 1, "observed": 0, "median_error_px": 0,
      "distance_m": 0, "angle_deg": 0, "inliers": )" +
           inliers + R"(, "file": ")" + file + "\"}]";
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
  folder_.write("out/loops/1.000000_1.200000.jpg", jpeg());
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
  folder_.write("secret.jpg", jpeg());
  folder_.write("out/loops/text.jpg", "not a picture");
  std::filesystem::create_symlink("../../secret.jpg", at("out/loops/link.jpg"));
  for (const char* file : {"../../secret.jpg", "link.jpg", "text.jpg", "", ".", ".."}) {
    folder_.write("out/loops/loops.json", index_of(file));
    const Run done = run("report '" + at("out") + "'");
    ASSERT_EQ(done.exit_code, kDone) << file << done.err;
    EXPECT_EQ(shown("out/report.html")[0]["loopPictures"].size(), 0U) << file;
  }
}

TEST_F(ReportCommand, ANewRunRemovesOnlyItsOwnPictures) {
  for (const char* file : {"1.000000_1.200000.jpg", "holiday.jpg", "2024_05.jpg"})
    folder_.write(std::string("out/loops/") + file, jpeg());
  ASSERT_EQ(run("run '" + at("data/walk") + "' -q -o '" + at("out") + "'").exit_code, kDone);
  EXPECT_FALSE(std::filesystem::exists(at("out/loops/1.000000_1.200000.jpg")));
  EXPECT_TRUE(std::filesystem::exists(at("out/loops/holiday.jpg")));
  EXPECT_TRUE(std::filesystem::exists(at("out/loops/2024_05.jpg")));
}

TEST_F(ReportCommand, CountsOfTheIndexMustBeWholeNumbers) {
  for (const char* count : {"1e300", "-1", "0.5", "4294967296"}) {
    folder_.write("out/loops/loops.json", index_of("x.jpg", count));
    const Run done = run("report '" + at("out") + "'");
    EXPECT_EQ(done.exit_code, kBadInput) << count;
    EXPECT_THAT(done.err, HasSubstr("\"inliers\": expected a whole number")) << count;
  }
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
