// kinloop features, end to end.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/random.hpp"
#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kDone;
using testing::AllOf;
using testing::HasSubstr;

class FeaturesCommand : public test::ProgramTest {
 protected:
  /// Two images of one scene of rectangles: the second shifted to the left and down.
  void SetUp() override {
    Random random(5);
    cv::Mat scene(400, 500, CV_8UC3, cv::Scalar::all(128));
    for (int i = 0; i < 600; ++i) {
      const auto below = [&](uint32_t count) { return static_cast<int>(random.index(count)); };
      const int height = 6 + below(30), width = 6 + below(30), top = below(390), left = below(490);
      const cv::Rect place(left, top, width, height);
      cv::rectangle(scene, place, cv::Scalar::all(random.index(256)), cv::FILLED);
    }
    cv::imwrite(at("a.png"), scene(cv::Rect(20, 20, 400, 300)));
    cv::imwrite(at("b.png"), scene(cv::Rect(35, 30, 380, 240)));
  }

  [[nodiscard]] std::string both() const { return "features '" + at("a.png") + "' '" + at("b.png") + "' "; }

  [[nodiscard]] nlohmann::json figures(const std::string& arguments) const {
    const Run done = run(arguments + " --detectors orb --json");
    EXPECT_EQ(done.exit_code, kDone) << done.err;
    return nlohmann::json::parse(done.out).at(0);
  }
};

TEST_F(FeaturesCommand, TwoImagesAreMatchedWithEachOther) {
  const auto orb = figures(both());
  EXPECT_EQ(orb["seeds"], 5);
  EXPECT_EQ(orb["pairs"], 5);
  EXPECT_GT(orb["matches"], 100);
  EXPECT_GT(orb["inliers"], 100);
  EXPECT_LE(orb["inliers"], orb["screened"]);
  EXPECT_LE(orb["screened"], orb["matches"]);
  EXPECT_FALSE(orb.contains("repeatability")) << "there is no ground truth";
}

TEST_F(FeaturesCommand, EachFigureHasItsRangeOverTheSeeds) {
  const auto orb = figures("features '" + at("a.png") + "' --seeds 3");
  EXPECT_EQ(orb["seeds"], 3);
  for (const char* key : {"keypoints", "milliseconds", "matches", "screened", "inliers", "repeatability",
                          "precision", "error_px"}) {
    ASSERT_TRUE(orb["ranges"].contains(key)) << key;
    EXPECT_LE(orb["ranges"][key][0], orb[key]) << key;
    EXPECT_GE(orb["ranges"][key][1], orb[key]) << key;
  }
  EXPECT_EQ(orb["ranges"]["matches"][0], orb["ranges"]["matches"][1]) << "the seed has no effect";
}

TEST_F(FeaturesCommand, SeedsSelectDifferentPairsOfASequence) {
  ASSERT_EQ(run("simulate room --frames 30 --size 160x120 -q -o '" + at("seq") + "'").exit_code, kDone);
  const std::string arguments = "features '" + at("seq") + "' --pairs 2 --gap 3 --set count=300";
  auto orb = figures(arguments), again = figures(arguments);
  EXPECT_EQ(orb["pairs"], 10);
  EXPECT_EQ(orb["images"], 20);
  EXPECT_LT(orb["ranges"]["matches"][0], orb["ranges"]["matches"][1]);
  for (auto* of : {&orb, &again}) {
    of->erase("milliseconds");
    of->at("ranges").erase("milliseconds");
  }
  EXPECT_EQ(orb, again) << "and the same ones with the same seed";
}

TEST_F(FeaturesCommand, TableShowsRangesBelowMedians) {
  const Run done = run(both() + "--detectors orb");
  EXPECT_THAT(done.out, AllOf(HasSubstr("ORB (ours)"), HasSubstr("5 seeds"), HasSubstr("same")));
}

TEST_F(FeaturesCommand, PicturesShowBothImagesAndTheFigures) {
  ASSERT_EQ(run(both() + "--detectors orb -o '" + at("pictures") + "'").exit_code, kDone);
  for (const char* name : {"orb_all.png", "orb_screened.png", "orb_inliers.png"}) {
    const cv::Mat picture = cv::imread(at("pictures/" + std::string(name)));
    EXPECT_EQ(picture.cols, 400 + 380) << name;
    EXPECT_GT(picture.rows, 300) << name << ": with a caption";
  }
}

TEST_F(FeaturesCommand, ReportsAMissingImage) {
  const Run absent = run("features '" + at("a.png") + "' '" + at("c.png") + "'");
  EXPECT_EQ(absent.exit_code, kBadInput);
  EXPECT_THAT(absent.err, HasSubstr("c.png"));
  EXPECT_EQ(run("features '" + at("a.png") + "' '" + folder_.path().string() + "'").exit_code, kBadInput);
}

}  // namespace
}  // namespace kinloop
