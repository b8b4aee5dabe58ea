#include "kinloop/eval/report.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "kinloop/base/time.hpp"
#include "kinloop/eval/report_text.hpp"
#include "kinloop/eval/svg_plot.hpp"

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
  RunReport report;
  report.estimate = circle(1.01);
  report.truth = circle(1);
  report.keyframes = {report.estimate[0], report.estimate[100], report.estimate[210]};
  report.map_picture_png = "\x89PNG";
  report.figures = {{"input", "my <room> & more"},
                    {"version", "kinloop 0.1.0"},
                    {"frames", 1352},
                    {"tracked", 1350},
                    {"keyframes", 3},
                    {"map", {{"points", 1049432}, {"voxel_m", 0.01}}},
                    {"rooms", {{"tracking", {{"wall_s", 13.52}, {"cpu_s", 13}}}}},
                    {"loops",
                     {{{"stamp_a", format_stamp(0)},
                       {"stamp_b", format_stamp(report.estimate[210].stamp_ns)},
                       {"inliers", 57}}}},
                    {"options", {{"features.count", 1000}, {"executor.mode", "lagged"}}},
                    {"evaluation", {{"ate", {{"rmse_m", 0.0123}}}}}};
  return report;
}

TEST(Report, ShowsTheFigures) {
  const auto page = render_report(full_report());
  EXPECT_THAT(page, HasSubstr("99.9 %"));
  EXPECT_THAT(page, HasSubstr("1&#8239;049&#8239;432"));
  EXPECT_THAT(page, HasSubstr("12.3 mm"));
  EXPECT_THAT(page, HasSubstr("<td>features.count</td><td>1000</td>"));
  EXPECT_THAT(page, HasSubstr("<td>executor.mode</td><td>lagged</td>"));
  EXPECT_THAT(page, HasSubstr("<td>tracking</td><td class=\"number\">10.00</td>"));
  EXPECT_THAT(page, HasSubstr("<td class=\"number\">57</td>"));
  EXPECT_THAT(page, HasSubstr("class=\"loop\""));
  EXPECT_THAT(page, HasSubstr("data:image/png;base64,iVBORw=="));
}

TEST(Report, NeedsNothingElse) {
  const auto page = render_report(full_report());
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("@import")));
  EXPECT_THAT(page, Not(HasSubstr("{{")));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

TEST(Report, TakesNoTextForMarkup) {
  const auto page = render_report(full_report());
  EXPECT_THAT(page, Not(HasSubstr("<room>")));
  EXPECT_THAT(page, HasSubstr("my &lt;room&gt; &amp; more"));
}

TEST(Report, LeavesOutWhatIsNotKnown) {
  auto report = full_report();
  report.truth.clear();
  report.figures.erase("evaluation");
  const auto page = render_report(report);
  EXPECT_THAT(page, Not(HasSubstr("<h2>Error</h2>")));
  EXPECT_THAT(page, Not(HasSubstr("ATE")));
  EXPECT_THAT(page, Not(HasSubstr(">truth<")));
  EXPECT_THAT(page, HasSubstr("From above"));
}

TEST(Report, OfNothingIsStillAPage) {
  const auto page = render_report({});
  EXPECT_THAT(page, HasSubstr("no frame was tracked"));
  EXPECT_THAT(page, HasSubstr("</html>"));
}

TEST(Report, ToleratesFiguresOfTheWrongKind) {
  RunReport report;
  report.figures = {
      {"frames", "many"}, {"loops", 7}, {"rooms", {{"a", 1}}}, {"options", nullptr}, {"map", {1, 2}}};
  EXPECT_THAT(render_report(report), HasSubstr("</html>"));
}

TEST(Report, OfACameraThatStoodStillHasPlots) {
  RunReport report;
  report.estimate.assign(5, {0, {Eigen::Quaterniond::Identity(), {1, 2, 3}}});
  const auto page = render_report(report);
  EXPECT_THAT(page, HasSubstr("From above"));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
  EXPECT_THAT(page, Not(HasSubstr("inf")));
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
  EXPECT_GT(v[1], v[5]);                        // y goes up
}

TEST(SvgHistogram, HasABarOfTheRightHeightForEveryValue) {
  const std::vector<double> values = {1, 1, 1, 9.9};
  const auto svg = svg_histogram({"h", "mm", "n", false, true}, values);
  size_t bars = 0;
  for (size_t at = svg.find("<rect"); at != std::string::npos; at = svg.find("<rect", at + 1)) ++bars;
  EXPECT_EQ(bars, 20U);  // of half a millimetre
  EXPECT_THAT(svg_histogram({"h", "mm", "n", false, true}, {}), Not(HasSubstr("nan")));
  EXPECT_THAT(svg_histogram({"h", "mm", "n", false, true}, std::vector<double>{0, 0}), Not(HasSubstr("nan")));
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
  EXPECT_EQ(fill_in("a {{x}} b {{y}}{{z}} {{", {{"x", "1{{y}}"}, {"y", "2"}}), "a 1{{y}} b 2 ");
  EXPECT_EQ(with_thousands(999), "999");
  EXPECT_EQ(with_thousands(-1234567), "-1&#8239;234&#8239;567");
}

}  // namespace
}  // namespace kinloop
