// What run and probe say of input that contradicts itself.

#include <filesystem>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "kinloop/sensor/images/image_file.hpp"
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
  void SetUp() override {
    const auto simulated =
        run("simulate room --seed 44 --frames 16 --fps 4 --size 160x120 -q -o '" + at("seq") + "'");
    ASSERT_EQ(simulated.exit_code, kDone) << simulated.err;
  }

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
  EXPECT_TRUE(nlohmann::json::parse(read_file(at("out/run.json")))["warnings"].empty());
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

}  // namespace
}  // namespace kinloop
