// kinloop eval as a user calls it: files and folders, formats, and what is said of odd input.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/apps/program_test.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kDone;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class EvalCommand : public test::ProgramTest {
 protected:
  EvalCommand() {
    // A circle and a straight line in TUM format; the estimates are a few millimetres off.
    for (int i = 0; i < 200; ++i) {
      const double t = 0.05 * i;
      circle_ += fmt::format("{:.6f} {:.6f} {:.6f} 0 0 0 {:.9f} {:.9f}\n", 10 + t, std::cos(t), std::sin(t),
                             std::sin(t / 2), std::cos(t / 2));
      rough_ += fmt::format("{:.6f} {:.6f} {:.6f} {} 0 0 {:.9f} {:.9f}\n", 10 + t, std::cos(t), std::sin(t),
                            i % 2 == 0 ? 0.004 : -0.004, std::sin(t / 2), std::cos(t / 2));
      line_ += fmt::format("{:.6f} {:.6f} 0 0 0 0 0 1\n", 10 + t, t);
    }
    folder_.write("truth.txt", circle_);
    folder_.write("a.txt", rough_);
    folder_.write("line.txt", line_);
  }

  [[nodiscard]] Run eval(const std::string& arguments) const {
    return run("eval " + arguments, "cd '" + folder_.path().string() + "';");
  }

  std::string circle_, rough_, line_;
};

TEST_F(EvalCommand, FoldersOfARunAndARecordingAreTheirTrajectories) {
  folder_.write("run/trajectory.txt", rough_);
  folder_.write("run/groundtruth.txt", circle_);
  folder_.write("run/run.json", "{}");
  folder_.write("sequence/groundtruth.txt", circle_);
  folder_.write("euroc/mav0/state_groundtruth_estimate0/data.csv",
                "#timestamp [s],p_x,p_y,p_z,q_x,q_y,q_z,q_w\n" + circle_);
  const Run files = eval("a.txt truth.txt");
  EXPECT_THAT(files.out, HasSubstr("ATE                  m      0.004000"));
  for (const char* paths :
       {"run", "run run", "run sequence", "run truth.txt", "a.txt sequence", "run euroc"}) {
    const Run found = eval(paths);
    EXPECT_EQ(found.exit_code, kDone) << paths << found.err;
    EXPECT_EQ(found.out, files.out) << paths;
  }
}

TEST_F(EvalCommand, SeveralEstimatesShareATable) {
  const Run text = eval("a.txt truth.txt truth.txt --rpe 1m --plot errors.svg");
  ASSERT_EQ(text.exit_code, kDone) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("RPE 1 m, deg"), HasSubstr("a.txt "), HasSubstr("0.004000")));
  EXPECT_THAT(read_file(at("errors.svg")), AllOf(HasSubstr("<svg"), HasSubstr("a.txt (ATE 0.0040 m)")));
  const auto json = nlohmann::json::parse(eval("a.txt truth.txt truth.txt --json").out);
  EXPECT_EQ(json.at(1).at("estimate"), "truth.txt");
  EXPECT_THAT(eval("a.txt truth.txt truth.txt --format csv").out,
              testing::StartsWith("estimate,ate_rmse_m,"));
  EXPECT_THAT(eval("a.txt truth.txt truth.txt --format latex").out, testing::StartsWith("\\begin{tabular}"));
}

TEST_F(EvalCommand, AStraightLineHasAnError) {
  const Run done = eval("line.txt line.txt");
  EXPECT_EQ(done.exit_code, kDone) << done.err;
  EXPECT_THAT(done.out, HasSubstr("ATE                  m      0.000000"));
}

TEST_F(EvalCommand, OptionsChangeWhatIsCompared) {
  EXPECT_EQ(nlohmann::json::parse(eval("a.txt truth.txt --offset 0.05 --json").out).at("ate").at("pairs"),
            199);
  EXPECT_EQ(eval("a.txt truth.txt --offset 0.021 --max-difference 0.02").exit_code, kBadInput);
  EXPECT_EQ(eval("a.txt truth.txt --offset 0.021 --max-difference 0.03").exit_code, kDone);
  for (const char* options : {"--align sim3", "--align yaw", "--align none", "--convention evo"}) {
    const Run done = eval(std::string("a.txt truth.txt --json ") + options);
    ASSERT_EQ(done.exit_code, kDone) << options << done.err;
    EXPECT_NEAR(nlohmann::json::parse(done.out).at("ate").at("rmse_m").get<double>(), 0.004, 1e-6) << options;
  }
}

TEST_F(EvalCommand, FaultsOfOtherToolsAreNamed) {
  const auto faults = test::shared_data("faults/eval");
  KINLOOP_SKIP_WITHOUT(faults);
  const std::string truth = test::shared_data("trajectories/tum_groundtruth/fr2_desk.txt").string();
  const std::string good = test::shared_data("trajectories/known_ate/fr2_desk_orbslam2.txt").string();
  const auto fault = [&](const char* name) { return (faults / name).string(); };
  for (const auto& arguments :
       {fault("two.txt") + " " + truth, fault("eq.txt") + " " + truth, good + " " + fault("gtwo.txt")}) {
    EXPECT_EQ(eval(arguments).exit_code, kBadInput) << arguments;
  }
  const Run few = eval(fault("few.txt") + " " + truth);
  EXPECT_THAT(few.err, HasSubstr("no RPE over 1 s: the poses are too sparse: 3.67 s apart"));
  EXPECT_THAT(few.out, testing::Not(HasSubstr("RPE 1 s")));
  EXPECT_THAT(eval(good + " " + truth).err, IsEmpty());
  EXPECT_THAT(eval(good + " " + truth + " --offset 1").err,
              HasSubstr("its clock seems to be off: with --offset -0.0"));
}

}  // namespace
}  // namespace kinloop
