// Comparisons of files with each other, and what is said of them.

#include "tools/evaluation/compare.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "kinloop/core/random.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/time.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/random_vectors.hpp"
#include "tools/evaluation/report/evaluation_plot.hpp"
#include "tools/evaluation/report/evaluation_table.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Thirty seconds of a handheld camera with some noise, at `step_s`.
Trajectory walk(double step_s = 0.05, double noise_m = 0.001) {
  Random random(9);
  Trajectory path;
  for (int i = 0; i * step_s < 30; ++i) {
    const double t = i * step_s, phase = t + std::sin(0.1 * t * t / 3);
    SE3 pose{exp_so3({0.4 * std::sin(phase), 0.2 * t, 0.3 * std::cos(1.7 * phase)}),
             {std::sin(phase), 0.3 * std::sin(0.7 * t), std::cos(1.3 * phase)}};
    pose.translation += noise_m * test::gaussian_vector<3>(random);
    path.push_back({to_ns(100 + t), pose});
  }
  return path;
}

NamedTrajectory named(const std::string& name, Trajectory poses) {
  return {name, {.poses = std::move(poses), .knows_quaternion_order = true}};
}

Comparison compared(Trajectory estimate, Trajectory truth = walk(0.05, 0),
                    const EvaluationOptions& options = {}) {
  return compare({named("a", std::move(estimate)), named("truth", std::move(truth)), options});
}

TEST(Compare, SaysNothingOfGoodInput) {
  const auto found = compared(walk());
  EXPECT_THAT(found.notes, IsEmpty());
  EXPECT_NEAR(found.evaluation.ate.error_m.rmse, 0.001 * std::sqrt(3), 2e-4);
}

TEST(Compare, NamesAClockThatIsOff) {
  const Trajectory late = shifted(walk(), 1'300'000'000);
  const auto found = compared(late);
  EXPECT_THAT(found.notes,
              ElementsAre(AllOf(HasSubstr("a: its clock seems to be off"), HasSubstr("--offset -1.30"))));
  const auto estimated = compare({named("a", late), named("truth", walk(0.05, 0)), {}, true});
  EXPECT_THAT(estimated.notes, ElementsAre(HasSubstr("are added to its time stamps")));
  EXPECT_NEAR(to_seconds(estimated.evaluation.offset_ns), -1.3, 2e-3);
  EXPECT_LT(estimated.evaluation.ate.error_m.rmse, 0.003);
  EXPECT_NEAR(to_seconds(estimated.estimate[0].stamp_ns), 100, 2e-3);
}

TEST(Compare, SaysThatPosesAreWorldToCamera) {
  const auto inverted = [](Trajectory path) {
    for (StampedPose& pose : path) pose.T_world_camera = pose.T_world_camera.inverse();
    return path;
  };
  EXPECT_THAT(compared(inverted(walk())).notes,
              testing::Contains(HasSubstr("a: its poses seem to be world to")));
  EXPECT_THAT(compared(walk(), inverted(walk(0.05, 0))).notes,
              testing::Contains(HasSubstr("truth: its poses seem to be world to camera")));
  EXPECT_THAT(compared(walk(0.05, 0.3)).notes, testing::Not(testing::Contains(HasSubstr("world to camera"))));
}

TEST(Compare, RefusesOtherClocksAndSaysTheOffset) {
  EXPECT_THAT(test::input_error([] { compared(shifted(walk(), 1000 * kNsPerSecond)); }),
              AllOf(HasSubstr("truth: fewer than three poses"), HasSubstr("or --offset -")));
  Trajectory short_clip = walk();
  short_clip.resize(20);
  EXPECT_THAT(test::input_error([&] {
                compare({named("a", short_clip), named("truth", walk()), {}, true});
              }),
              HasSubstr("the clock offset from truth cannot be estimated"));
}

TEST(Compare, RefusesRepeatedStampsAndPositionsBeyondTheWorld) {
  Trajectory twice = walk();
  for (const auto& pose : walk()) twice.push_back(pose);
  std::stable_sort(twice.begin(), twice.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
  EXPECT_THAT(test::input_error([&] { compared(twice); }), HasSubstr("a: 600 of 1200 time stamps repeat"));
  Trajectory far = walk();
  far[3].T_world_camera.translation.x() = 1e7;
  EXPECT_THAT(test::input_error([&] { compared(far); }), HasSubstr("1000 km from the origin"));
}

TEST(Compare, SaysWhyThereIsNoRpe) {
  EvaluationOptions options;
  options.rpe = {{500, RpeDelta::Unit::kMeters}};
  const auto found = compared(walk(2.5), walk(0.05, 0), options);
  EXPECT_FALSE(found.evaluation.rpe_second);
  EXPECT_THAT(found.notes, ElementsAre("a: no RPE over 1 s: the poses are too sparse: 2.5 s apart (median)",
                                       HasSubstr("a: no RPE over 500 m: fewer than two motions")));
}

TEST(Compare, PosesWithoutStampsAreComparedOneByOne) {
  auto numbered = [](const std::string& name, size_t count) {
    auto trajectory = named(name, walk());
    trajectory.file.has_stamps = false;
    trajectory.file.poses.resize(count);
    for (size_t i = 0; i < count; ++i)
      trajectory.file.poses[i].stamp_ns = static_cast<int64_t>(i) * kNumberedStepNs;
    return trajectory;
  };
  const auto with_truth = compare({numbered("k", 600), named("truth", walk(0.05, 0))});
  EXPECT_EQ(with_truth.evaluation.ate.error_m.count, 600U);
  EXPECT_TRUE(with_truth.evaluation.rpe_second);
  EXPECT_THAT(with_truth.notes, ElementsAre("k: has no time stamps; compared pose by pose"));

  const auto both = compare({numbered("k", 600), numbered("t", 600)});
  EXPECT_EQ(both.evaluation.coverage.time_fraction, 1);
  EXPECT_FALSE(both.evaluation.rpe_second);
  EXPECT_TRUE(both.evaluation.rpe_frame);
  EXPECT_THAT(test::input_error([&] {
                compare({numbered("k", 599), numbered("t", 600)});
              }),
              HasSubstr("k: has no time stamps, and another number of poses (599) than t (600)"));
}

TEST(Compare, TakesQuaternionsInTheOrderThatFits) {
  auto estimate = named("a", walk());
  estimate.file.knows_quaternion_order = false;
  for (auto& pose : estimate.file.poses) {
    const auto q = pose.T_world_camera.rotation;
    pose.T_world_camera.rotation = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y());
  }
  const auto found = compare({estimate, named("truth", walk(0.05, 0))});
  EXPECT_THAT(found.notes, ElementsAre(HasSubstr("a: quaternions are taken as qw qx qy qz")));
  ASSERT_TRUE(found.evaluation.rpe_second);
  EXPECT_LT(found.evaluation.rpe_second->rotation_deg.max, 1e-6);
}

std::vector<NamedEvaluation> two_estimates() {
  EvaluationOptions options;
  options.rpe = {{1, RpeDelta::Unit::kMeters}};
  return {{"a_1,b", compared(walk(), walk(0.05, 0), options).evaluation},
          {"sparse", compared(walk(2.5), walk(0.05, 0), options).evaluation}};
}

size_t count(const std::string& text, const std::string& part) {
  size_t found = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(EvaluationTable, OfSeveralHasARowEach) {
  const auto all = two_estimates();
  const std::string text = evaluation_table(all, TableFormat::kText);
  EXPECT_EQ(count(text, "\n"), 3U);
  EXPECT_THAT(text, AllOf(HasSubstr("ATE rmse, m"), HasSubstr("RPE 1 m, deg"), HasSubstr("a_1,b")));
  const std::string csv = evaluation_table(all, TableFormat::kCsv);
  EXPECT_THAT(csv, AllOf(HasSubstr("estimate,ate_rmse_m,ate_mean_m"), HasSubstr("\"a_1,b\",0.00"),
                         HasSubstr("rpe_1m_rmse_deg,scale")));
  EXPECT_THAT(csv, HasSubstr(",,,")) << "no RPE over 1 s";
  const std::string latex = evaluation_table(all, TableFormat::kLatex);
  EXPECT_THAT(latex, AllOf(HasSubstr("\\begin{tabular}{lrrr"), HasSubstr("a\\_1,b & 0.00"),
                           HasSubstr("coverage, \\%")));
  EXPECT_EQ(count(latex, " \\\\\n"), 3U);
  const auto json = parse_json(evaluation_table(all, TableFormat::kJson));
  ASSERT_EQ(json.size(), 2U);
  EXPECT_EQ(json[0].at("estimate"), "a_1,b");
  EXPECT_TRUE(json[1].at("rpe_1s").is_null());
  EXPECT_EQ(json[0].at("rpe")[0].at("delta"), "1 m");
}

TEST(EvaluationTable, NamesAreEscapedForTheFormat) {
  auto all = two_estimates();
  all[0].name = "=1+1";
  all[1].name = "@a\n\x1b[2J,b";
  const std::string csv = evaluation_table(all, TableFormat::kCsv);
  EXPECT_THAT(csv, AllOf(HasSubstr("\n'=1+1,0.00"), HasSubstr("\n\"'@a\n\x1b[2J,b\",0.00")));
  for (const TableFormat format : {TableFormat::kText, TableFormat::kLatex}) {
    const std::string table = evaluation_table(all, format);
    EXPECT_EQ(count(table, "\x1b"), 0U);
    EXPECT_EQ(count(table, "a\n"), 0U);
  }
}

TEST(EvaluationTable, OfOneHasAllStatistics) {
  const auto all = two_estimates();
  const std::string text = evaluation_table(std::span(all).first(1), TableFormat::kText);
  EXPECT_THAT(text,
              AllOf(HasSubstr("median"), HasSubstr("RPE 1 m rotation"), HasSubstr("coverage   100.0 %")));
  EXPECT_EQ(parse_json(evaluation_table(std::span(all).first(1), TableFormat::kJson)).at("ate").at("pairs"),
            600);
  EXPECT_EQ(evaluation_table({}, TableFormat::kText), "");
}

TEST(EvaluationPlot, HoldsPathsAndErrors) {
  const auto found = compared(walk());
  const std::vector<PlottedEstimate> plotted = {{"<a & b>", found.estimate, found.evaluation},
                                                {"b", found.estimate, found.evaluation}};
  const std::string svg = evaluation_plot(plotted, found.truth);
  EXPECT_THAT(
      svg, AllOf(testing::StartsWith("<svg xmlns="), testing::EndsWith("</svg>\n"),
                 HasSubstr("&lt;a &amp; b&gt;"), HasSubstr("x, m"), HasSubstr("z, m"), HasSubstr("time, s")));
  EXPECT_EQ(count(svg, "<polyline"), 5U);
  EXPECT_THAT(svg, testing::Not(HasSubstr("nan")));
}

TEST(EvaluationPlot, OfACameraThatStoodStillIsFinite) {
  Trajectory still;
  for (int i = 0; i < 5; ++i) still.push_back({i * kNsPerSecond, {}});
  const auto found = compared(still, still);
  const std::vector<PlottedEstimate> plotted = {{"a", found.estimate, found.evaluation}};
  EXPECT_THAT(evaluation_plot(plotted, found.truth), testing::Not(testing::ContainsRegex("nan|inf")));
}

}  // namespace
}  // namespace kinloop
