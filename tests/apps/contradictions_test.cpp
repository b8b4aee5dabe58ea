// What run and probe say of input that contradicts itself.

#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/files/file_lock.hpp"
#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kDone;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Contradictions : public test::ProgramTest {
 protected:
  void SetUp() override { test::write_room(at("seq"), "--seed 44 --frames 16 --fps 4"); }

  void flip_depth() const {
    for (const auto& entry : std::filesystem::directory_iterator(at("seq/depth"))) {
      const cv::Mat depth = cv::imread(entry.path().string(), cv::IMREAD_UNCHANGED);
      cv::Mat flipped;
      cv::flip(depth, flipped, 0);
      write_png(entry.path(), flipped);
    }
  }
};

TEST_F(Contradictions, NothingIsSaidOfACleanRecording) {
  const auto probed = run("probe '" + at("seq") + "'");
  EXPECT_EQ(probed.exit_code, kDone);
  EXPECT_THAT(probed.err, Not(HasSubstr("warning")));
  const auto mapped = run("run '" + at("seq") + "' -o '" + at("out") + "'");
  EXPECT_THAT(mapped.err, Not(HasSubstr("registered to colour")));
  const auto figures = nlohmann::json::parse(read_file(at("out/run.json")));
  EXPECT_TRUE(figures["warnings"].empty());
  EXPECT_TRUE(figures["advice"].empty()) << figures["advice"];
}

TEST_F(Contradictions, RunListsWhatSpoiledTheRecording) {
  for (const auto& entry : std::filesystem::directory_iterator(at("seq/rgb"))) {
    const cv::Mat color = cv::imread(entry.path().string());
    write_png(entry.path(), cv::Mat(0.25 * color));
  }
  (void)run("run '" + at("seq") + "' -o '" + at("out") + "'");
  const auto advice = nlohmann::json::parse(read_file(at("out/run.json")))["advice"];
  const auto dark = std::ranges::find_if(advice, [](const auto& hint) { return hint["kind"] == "too_dark"; });
  ASSERT_NE(dark, advice.end()) << advice;
  EXPECT_THAT((*dark)["advice"].template get<std::string>(), HasSubstr("light"));
  EXPECT_NEAR((*dark)["seconds"].template get<double>(), 15 * 0.25 - 0.5, 0.01)
      << "all but the first half second";
}

TEST_F(Contradictions, ProbeAndRunRefuseDepthThatIsUpsideDown) {
  flip_depth();
  for (const std::string& command :
       {"probe '" + at("seq") + "'", "run '" + at("seq") + "' -o '" + at("out") + "'"}) {
    const auto refused = run(command);
    EXPECT_EQ(refused.exit_code, kBadInput);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("upside down"), HasSubstr("flip the images")));
  }
}

TEST_F(Contradictions, RunListsWarningsInItsSummary) {
  ASSERT_EQ(shell("sed -i 's/^cx:.*/cx: 159/; s/^cy:.*/cy: 121/' '" + at("seq/camera.yaml") + "'").exit_code,
            kDone);
  const auto mapped = run("run '" + at("seq") + "' -o '" + at("out") + "'");
  EXPECT_THAT(mapped.err, HasSubstr("half of all values fits these images"));
  const auto warnings = nlohmann::json::parse(read_file(at("out/run.json")))["warnings"];
  ASSERT_FALSE(warnings.empty());
  EXPECT_EQ(warnings[0]["kind"], "intrinsics");
  EXPECT_THAT(warnings[0]["remedy"].get<std::string>(), HasSubstr("half of all values"));
}

TEST_F(Contradictions, UpIsWhatTheUserSays) {
  const auto mapped = run("run '" + at("seq") + "' --up -1,0,0 -q -o '" + at("out") + "'");
  ASSERT_EQ(mapped.exit_code, kDone) << mapped.err;
  const auto up = nlohmann::json::parse(read_file(at("out/run.json")))["up"];
  EXPECT_EQ(up["source"], "given");
  EXPECT_EQ(up["direction"], nlohmann::json({-1.0, 0.0, 0.0}));
  const auto exported = run("mesh '" + at("out") + "' -o '" + at("mesh.ply") + "' --up 0,0,0");
  EXPECT_EQ(exported.exit_code, test::kWrongUse);
  EXPECT_THAT(exported.err, HasSubstr("no direction"));
}

TEST_F(Contradictions, DepthOfAnotherClockIsShifted) {
  ASSERT_EQ(
      shell("cd '" + at("seq") +
            "' && rm -f associations.txt && awk '!/#/ {$1 += 1} {print}' depth.txt > d && mv d depth.txt")
          .exit_code,
      kDone);
  const auto as_it_is = run("run '" + at("seq") + "' -q -o '" + at("a") + "'");
  const auto shifted = run("run '" + at("seq") + "' --depth-offset -1 -q -o '" + at("b") + "'");
  EXPECT_EQ(shifted.exit_code, kDone) << shifted.err;
  EXPECT_NE(nlohmann::json::parse(read_file(at("b/run.json")))["frames"], 0);
  EXPECT_NE(as_it_is.exit_code, test::kWrongUse);
  EXPECT_EQ(run("run '" + at("seq") + "' --depth-offset 60").exit_code, test::kWrongUse);
}

TEST_F(Contradictions, TwoRunsDoNotSaveTheirMapsIntoOneFile) {
  const FileLock other(at("map.kinmap"));
  const auto refused =
      run("run '" + at("seq") + "' -q -o '" + at("out") + "' --save-map '" + at("map.kinmap") + "'");
  EXPECT_EQ(refused.exit_code, kBadInput);
  EXPECT_THAT(refused.err, AllOf(HasSubstr(at("map.kinmap")), HasSubstr("another run")));
}

TEST_F(Contradictions, ControlCharactersOfAPathAreEscapedOnStandardOutput) {
  const auto simulated = run("simulate room --frames 2 --size 160x120 -o '" + at("a\033[2J") + "'");
  EXPECT_THAT(simulated.out, AllOf(HasSubstr("\\x1b[2J"), Not(HasSubstr("\033"))));
  EXPECT_EQ(run("simulate room --frames 2 --size 160x120 -q -o '" + at("b") + "'").out, "");
}

}  // namespace
}  // namespace kinloop
