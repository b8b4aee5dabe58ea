#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "drivers/image_files/image_file.hpp"
#include "session/plan/run_plan.hpp"
#include "session/source/source_filters.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MaskFile : public testing::Test {
 protected:
  /// Writes an image that is black in its left half.
  [[nodiscard]] std::filesystem::path write(const cv::Size& size) const {
    cv::Mat image(size, CV_8UC1, cv::Scalar(255));
    image(cv::Rect(0, 0, size.width / 2, size.height)) = 0;
    write_png(folder_.path() / "mask.png", image);
    return folder_.path() / "mask.png";
  }

  /// A run of two frames of 64 x 48 pixels with this mask.
  static RunPlan plan_with(const std::filesystem::path& mask) {
    RunRequest request;
    request.source.sequence = "sim:room";
    request.source.mask = mask;
    request.settings.assignments = {"sim.frames=2", "sim.width=64", "sim.height=48"};
    return plan_run(request);
  }

  test::TempFolder folder_;
};

TEST_F(MaskFile, ReachesEveryFrame) {
  const RunPlan plan = plan_with(write({64, 48}));
  int frames = 0;
  for (; const auto frame = plan.source->next(); ++frames) EXPECT_EQ(cv::countNonZero(frame->mask), 32 * 48);
  EXPECT_EQ(frames, 2);
}

TEST_F(MaskFile, OfAnotherSizeIsAnErrorThatNamesBothSizes) {
  const auto path = write({32, 24});
  EXPECT_THAT(test::input_error([&] { plan_with(path); }),
              AllOf(HasSubstr("mask.png"), HasSubstr("32 x 24"), HasSubstr("64 x 48")));
}

TEST_F(MaskFile, ThatIgnoresEverythingIsAnError) {
  const auto path = folder_.path() / "black.png";
  write_png(path, cv::Mat::zeros(48, 64, CV_8UC1));
  EXPECT_THAT(test::input_error([&] { plan_with(path); }), AllOf(HasSubstr("black.png"), HasSubstr("white")));
}

TEST_F(MaskFile, ThatIsNoImageIsAnError) {
  folder_.write("mask.png", "no image");
  EXPECT_THAT(test::input_error([&] { plan_with(folder_.path() / "mask.png"); }), HasSubstr("mask.png"));
}

}  // namespace
}  // namespace kinloop
