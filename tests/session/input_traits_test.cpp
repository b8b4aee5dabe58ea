#include "session/input/input_traits.hpp"

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "session/plan/run_plan.hpp"
#include "session/source/source_filters.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

constexpr double kMillimetres = 1000, kTumUnits = 5000;

/// Depth from `near_m` in the first row to `far_m` in the last.
std::deque<Frame> frames_with_depth(float near_m, float far_m) {
  constexpr int kRows = 480;
  Frame frame;
  frame.depth_m = cv::Mat(kRows, 640, CV_32FC1);
  for (int y = 0; y < kRows; ++y)
    frame.depth_m.row(y) = near_m + (far_m - near_m) * static_cast<float>(y) / static_cast<float>(kRows);
  return {frame};
}

TEST(NearMinimum, IsBelowTheDepthOfANearScene) {
  const auto minimum_m = near_minimum_m(frames_with_depth(0.2F, 0.4F), {}, kMillimetres);
  ASSERT_TRUE(minimum_m);
  EXPECT_NEAR(*minimum_m, 0.105, 0.01);
}

TEST(NearMinimum, StaysIfMostDepthIsInTheRange) {
  EXPECT_FALSE(near_minimum_m(frames_with_depth(0.2F, 0.8F), {}, kMillimetres));
  EXPECT_FALSE(near_minimum_m(frames_with_depth(1, 3), {}, kMillimetres));
  EXPECT_FALSE(near_minimum_m(frames_with_depth(0, 0), {}, kMillimetres));
  EXPECT_FALSE(near_minimum_m({}, {}, kMillimetres));
}

TEST(NearMinimum, StaysIfAnotherScaleMakesItARoomOrNoCameraSeesThat) {
  EXPECT_FALSE(near_minimum_m(frames_with_depth(0.2F, 0.4F), {}, kTumUnits));
  EXPECT_FALSE(near_minimum_m(frames_with_depth(0.02F, 0.08F), {}, kMillimetres));
}

/// Two frames, and then an error.
class FailingSource : public FrameSource {
 public:
  std::optional<Frame> next() override {
    if (given_ == 2) throw InputError("the third frame");
    Frame frame;
    frame.id = FrameId{given_++};
    return frame;
  }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override { return {}; }

 private:
  uint32_t given_ = 0;
  RgbdCamera camera_;
  SourceInfo info_;
};

TEST(PeekedSource, GivesTheFramesInOrderAndTheErrorInItsTurn) {
  for (const size_t ahead : {size_t{0}, size_t{1}, size_t{2}, size_t{10}}) {
    PeekedSource source(std::make_unique<FailingSource>(), ahead);
    EXPECT_EQ(source.first_frames().size(), std::min(ahead, size_t{2}));
    EXPECT_EQ(source.next()->id.value, 0U);
    EXPECT_EQ(source.next()->id.value, 1U);
    EXPECT_EQ(test::input_error([&] { static_cast<void>(source.next()); }), "the third frame");
  }
}

/// A folder with two frames whose depth lies between 0.2 and 0.4 m.
class NearFolder : public testing::Test {
 protected:
  NearFolder() {
    camera_.color.width = 640, camera_.color.height = 480;
    camera_.color.fx = camera_.color.fy = 525, camera_.color.cx = 319.5, camera_.color.cy = 239.5;
    camera_.depth_scale = kMillimetres;
    const cv::Mat depth_m = frames_with_depth(0.2F, 0.4F).front().depth_m;
    for (const char* folder : {"rgb", "depth"}) std::filesystem::create_directories(folder_.path() / folder);
    for (const char* name : {"1.png", "2.png"}) {
      write_png(folder_.path() / "rgb" / name, cv::Mat(depth_m.size(), CV_8UC3, cv::Scalar(9, 9, 9)));
      write_depth_png(folder_.path() / "depth" / name, depth_m, kMillimetres);
    }
  }

  [[nodiscard]] double minimum_m(std::vector<std::string> assignments = {}) const {
    write_camera_file(folder_.path() / "camera.yaml", camera_);
    RunRequest request;
    request.source.sequence = folder_.path().string();
    request.settings.assignments = std::move(assignments);
    return plan_run(request).options.mesh.limits.min_depth_m;
  }

  RgbdCamera camera_;
  test::TempFolder folder_;
};

TEST_F(NearFolder, IsMappedFromWhereItsDepthBegins) {
  EXPECT_NEAR(minimum_m(), 0.105, 0.01);
}

TEST_F(NearFolder, HasTheMinimumThatTheUserChooses) {
  EXPECT_EQ(minimum_m({"dense.min_depth_m=0.3"}), 0.3);
}

TEST_F(NearFolder, HasTheMinimumOfASensorThatIsKnown) {
  camera_.sensor = depth_sensor(DepthSensorModel::kRealsenseL515, SensorOrigin::kCameraFile);
  EXPECT_EQ(minimum_m(), camera_.sensor.min_depth_m);
  EXPECT_EQ(minimum_m({"dense.min_depth_m=0.1"}), 0.1) << "unless the user knows better";
}

}  // namespace
}  // namespace kinloop
