#include "viewer/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/base64.hpp"
#include "kinloop/core/time.hpp"
#include "tests/support/temp_folder.hpp"
#include "viewer/report/html_page.hpp"
#include "viewer/report/svg_plot.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;
using testing::Not;

Trajectory circle(double radius_m) {
  Trajectory path;
  for (int i = 0; i < 300; ++i) {
    const double t = 0.03 * i;
    path.push_back(
        {i * (kNsPerSecond / 30),
         {exp_so3({0, t, 0}), {radius_m * std::cos(t), 0.1 * std::sin(3 * t), radius_m * std::sin(t)}}});
  }
  return path;
}

RunReport full_report() {
  RunReport run;
  run.name = "my <room> & more";
  run.estimate = circle(1.01);
  run.truth = circle(1);
  run.keyframes = {run.estimate[0], run.estimate[100], run.estimate[210]};
  run.frames = {{0, "tracked", 1000, 640, 12.5, 0.001}, {kNsPerSecond / 2, "lost", 900, 0, 30, 0}};
  run.loop_images = {{"met again", "\x89JPG"}};
  run.metrics = {{"frames", 300},
                 {"loops",
                  {{{"stamp_a", format_stamp(0)},
                    {"stamp_b", format_stamp(run.estimate[210].stamp_ns)},
                    {"inliers", 57}},
                   {{"stamp_a", "1.5"}, {"stamp_b", "no stamp"}}}},
                 {"keyframe_covariances", {1, 2, 3}}};
  return run;
}

nlohmann::json data_of(const RunReport& run) {
  return report_data({&run, 1})["runs"][0];
}

TEST(Report, HoldsPathsErrorsAndFigures) {
  const auto data = data_of(full_report());
  EXPECT_EQ(data["path"]["x"].size(), 300U);
  EXPECT_EQ(data["truth"]["z"].size(), 300U);
  EXPECT_EQ(data["errors"]["mm"].size(), 300U);
  EXPECT_NEAR(data["errors"]["mm"][5].get<double>(), 10, 2);  // a hundredth of a metre
  EXPECT_NEAR(data["evaluation"]["ate"]["rmse_m"].get<double>(), 0.01, 2e-3);
  EXPECT_EQ(data["frames"]["tracked"][0], 640);
  EXPECT_EQ(data["frames"]["t"][1], 0.5);
  EXPECT_EQ(data["figures"]["frames"], 300);
  EXPECT_FALSE(data["figures"].contains("keyframe_covariances"));
}

TEST(Report, AlignsTheEstimateWithGroundTruth) {
  const auto data = data_of(full_report());
  for (size_t i = 0; i < 300; ++i) {
    for (const char* axis : {"x", "y", "z"}) {
      EXPECT_NEAR(data["path"][axis][i].get<double>(), data["truth"][axis][i].get<double>(), 0.03);
    }
  }
}

TEST(Report, FromAboveTheHeightIsLeftOut) {
  const auto data = data_of(full_report());
  const auto extent = [&](const char* axis) {
    const auto values = data["path"][axis].get<std::vector<double>>();
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low;
  };
  EXPECT_NEAR(extent("x"), 2.02, 0.05);
  EXPECT_NEAR(extent("y"), 2.02, 0.05);
  EXPECT_NEAR(extent("z"), 0.2, 0.05);
}

TEST(Report, LoopsArePairsOfKeyframesAndUnknownOnesAreLeftOut) {
  EXPECT_EQ(data_of(full_report())["loops"], nlohmann::json::parse("[[0, 2]]"));
}

TEST(Report, HoldsTheLoopsThatAreNoEdgesAndTheStartThatTheirTimesReferTo) {
  RunReport run = full_report();
  run.metrics["other_loops"] = {{{"stamp_a", "1.5"}, {"stamp_b", "2"}, {"status", "rejected"}}};
  run.frames.front().stamp_ns = kNsPerSecond / 4;
  const auto data = data_of(run);
  EXPECT_EQ(data["figures"]["other_loops"], run.metrics["other_loops"]);
  EXPECT_EQ(data["startS"], 0.25);
}

TEST(Report, LeavesOutWhatIsNotKnown) {
  RunReport run = full_report();
  run.truth.clear();
  const auto data = data_of(run);
  EXPECT_FALSE(data.contains("errors"));
  EXPECT_FALSE(data.contains("truth"));
  EXPECT_FALSE(data.contains("evaluation"));
}

TEST(Report, OfSeveralRunsAllLieOnTheSameTruth) {
  RunReport other = full_report();
  const SE3 T_other{exp_so3({0.3, 1, -0.2}), {5, 6, 7}};  // another start
  for (auto& pose : other.estimate) pose.T_world_camera = T_other * pose.T_world_camera;
  const std::vector<RunReport> runs = {full_report(), other};
  const auto data = report_data(runs)["runs"];
  for (size_t i = 0; i < 300; i += 50) {
    EXPECT_NEAR(data[0]["path"]["x"][i].get<double>(), data[1]["path"]["x"][i].get<double>(), 1e-3);
    EXPECT_NEAR(data[0]["path"]["z"][i].get<double>(), data[1]["path"]["z"][i].get<double>(), 1e-3);
  }
  EXPECT_EQ(data[0]["loopPictures"].size(), 1U);
  EXPECT_EQ(data[1]["loopPictures"].size(), 0U);
}

TEST(Report, IsSelfContainedAndEscapesText) {
  RunReport run = full_report();
  run.name = "</script><b>bold</b>";
  const std::string page = render_report({&run, 1});
  EXPECT_THAT(page, HasSubstr("</html>"));
  EXPECT_THAT(page, HasSubstr("\\u003c/script>\\u003cb>bold"));
  EXPECT_THAT(page, Not(HasSubstr("<b>bold")));
  for (const char* reference : {"<link", "src=\"http", "@import", "url(http"}) {
    EXPECT_THAT(page, Not(HasSubstr(reference)));
  }
}

TEST(Report, IsCalledByItsSequence) {
  EXPECT_EQ(input_name("sim:room"), "sim:room");
  EXPECT_EQ(input_name("kinect1"), "kinect1");
  EXPECT_EQ(input_name("redkitchen"), "redkitchen");
  EXPECT_EQ(input_name("../shared/data/redkitchen"), "redkitchen");
  EXPECT_EQ(input_name("/data/redkitchen//"), "redkitchen");
  EXPECT_EQ(input_name("/data/walk.bag"), "walk.bag");
  EXPECT_EQ(input_name("/"), "/");
  EXPECT_EQ(input_name(""), "");
}

TEST(Report, SeveralRunsGetShortestUniqueNames) {
  const auto names = [](const std::vector<std::string>& paths) { return unique_short_names(paths); };
  EXPECT_THAT(names({"/runs/with", "/runs/without"}), testing::ElementsAre("with", "without"));
  EXPECT_THAT(names({"/a/out", "/b/out", "/b/other"}), testing::ElementsAre("a/out", "b/out", "b/other"));
  EXPECT_THAT(names({"out", "b/out"}), testing::ElementsAre("out", "b/out"));
  EXPECT_THAT(names({"/out", "/out"}), testing::SizeIs(2)) << "the same path twice";
}

TEST(Report, BeginsWithItsFirstFrame) {
  RunReport run;
  EXPECT_EQ(start_stamp_ns(run), 0);
  run.estimate = {{kNsPerSecond, {}}};
  EXPECT_EQ(start_stamp_ns(run), kNsPerSecond);
  run.frames = {{kNsPerSecond / 2, "lost", 0, 0, 0}};
  EXPECT_EQ(start_stamp_ns(run), kNsPerSecond / 2);
}

TEST(Report, OfNothingIsStillAPage) {
  EXPECT_THAT(render_report({}), HasSubstr("</html>"));
  const RunReport empty;
  EXPECT_THAT(render_report({&empty, 1}), HasSubstr("</html>"));
}

TEST(Report, ToleratesFiguresOfTheWrongKind) {
  RunReport run;
  run.metrics = {
      {"frames", "many"}, {"loops", 7}, {"timings", {{"a", 1}}}, {"options", nullptr}, {"map", {1, 2}}};
  EXPECT_EQ(data_of(run)["loops"].size(), 0U);
  run.metrics = {{"loops", {1, {{"stamp_a", 3}}}}};
  EXPECT_EQ(data_of(run)["loops"].size(), 0U);
  run.metrics = "no object";
  EXPECT_TRUE(data_of(run)["figures"].is_object());
}

TEST(Report, StationaryCameraGivesFiniteNumbers) {
  RunReport run;
  run.estimate.assign(5, {0, {Eigen::Quaterniond::Identity(), {1, 2, 3}}});
  const auto data = data_of(run);
  ASSERT_FALSE(data["path"]["x"].empty());
  for (const auto& x : data["path"]["x"]) EXPECT_TRUE(x.is_number());
}

class FrameTableFile : public testing::Test {
 protected:
  test::TempFolder folder_;
  std::filesystem::path path_ = folder_.path() / "frames.txt";
};

TEST_F(FrameTableFile, ComesBackAsItWasWritten) {
  const FrameTable table = {{1311868164363, "doubtful", 1000, 640, 12.5, 0.0625, "hidden", 800, 0.25, 0.5},
                            {1311868164399, "lost", 0, 0, 0.125, 0}};
  write_frame_table(path_, table);
  const FrameTable back = read_frame_table(path_);
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].stamp_ns, table[0].stamp_ns);
  EXPECT_EQ(back[0].status, "doubtful");
  EXPECT_EQ(back[0].tracked, 640);
  EXPECT_EQ(back[0].sigma_m, 0.0625);
  EXPECT_EQ(back[0].cause, "hidden");
  EXPECT_EQ(back[0].expected, 800);
  EXPECT_EQ(back[0].contradicted, 0.25);
  EXPECT_EQ(back[0].moved, 0.5);
  EXPECT_EQ(back[1].cause, "-");
  EXPECT_EQ(back[1].status, "lost");
  EXPECT_EQ(back[1].ms, 0.125);
}

TEST_F(FrameTableFile, OfAnEarlierVersionHasNoSigma) {
  write_file(path_, "# stamp_s status features tracked ms\n1.0 dense 900 64 12.5\n");
  const FrameTable table = read_frame_table(path_);
  ASSERT_EQ(table.size(), 1U);
  EXPECT_EQ(table[0].ms, 12.5);
  EXPECT_EQ(table[0].sigma_m, 0);
}

TEST_F(FrameTableFile, OfVersion02EndsWithSigma) {
  write_file(path_, "# stamp_s status features tracked ms sigma_m\n1.0 dense 900 64 12.5 0.25\n");
  const FrameTable table = read_frame_table(path_);
  ASSERT_EQ(table.size(), 1U);
  EXPECT_EQ(table[0].sigma_m, 0.25);
  EXPECT_EQ(table[0].cause, "-");
}

TEST_F(FrameTableFile, SaysWhereItIsDamaged) {
  for (const char* row : {"1.0 tracked 5", "x tracked 5 5 5", "1.0 tracked 5 y 5", "1.0 tracked 5 5 5 y",
                          "1.0 tracked 5 5 5 5 5"}) {
    write_file(path_, std::string("# head\n1.0 tracked 5 5 5\n") + row + "\n");
    try {
      read_frame_table(path_);
      FAIL() << row;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("frames.txt:3")) << row;
    }
  }
}

TEST(SvgPlot, OnEqualAxesACircleIsRound) {
  PlotSeries diamond{"estimate", "", SeriesKind::kLine, {{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};
  const auto svg = svg_plot({"d", "m", "m", true, false}, {&diamond, 1});
  std::array<double, 8> v{};
  const auto at = svg.find("class=\"estimate\" d=\"");
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(std::sscanf(svg.c_str() + at, "class=\"estimate\" d=\"M%lf %lfL%lf %lfL%lf %lfL%lf %lf", &v[0],
                        &v[1], &v[2], &v[3], &v[4], &v[5], &v[6], &v[7]),
            8);
  EXPECT_NEAR(v[2] - v[6], v[1] - v[5], 0.21);  // as wide as high, up to rounding
  EXPECT_GT(v[1], v[5]);                        // y points up
}

TEST(ReportText, Base64IsThatOfTheRfc) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(ReportText, FillsInNamesAndLeavesTheRest) {
  EXPECT_EQ(fill_template("a {{x}} b {{y}}{{z}} {{", {{"x", "1{{y}}"}, {"y", "2"}}), "a 1{{y}} b 2 ");
  EXPECT_EQ(format_with_thousands(999), "999");
  EXPECT_EQ(format_with_thousands(-1234567), "-1&#8239;234&#8239;567");
}

}  // namespace
}  // namespace kinloop
