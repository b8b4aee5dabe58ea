#include "drivers/openni2/openni2_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

#ifdef KINLOOP_WITH_OPENNI2

#include <chrono>
#include <thread>

#include <opencv2/core.hpp>
#include <openni2/OpenNI.h>

#include "drivers/openni2/oni_source.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kDummy = "Dummy";  ///< the library's own device: 320 x 240, a disc that moves
constexpr int64_t kDummyPeriod_ns = 33'000'000;

/// The library's dummy device and its streams. They are never closed: it does not wait for its threads, which
/// then crash.
struct DummyDevice {
  openni::Device device;
  openni::VideoStream color, depth;
  bool opened = openni::OpenNI::initialize() == openni::STATUS_OK &&
                device.open(kDummy) == openni::STATUS_OK &&
                color.create(device, openni::SENSOR_COLOR) == openni::STATUS_OK &&
                depth.create(device, openni::SENSOR_DEPTH) == openni::STATUS_OK;
};
DummyDevice& dummy() {
  static auto* const kDevice = new DummyDevice;
  return *kDevice;
}

class OpenNi2Test : public testing::Test {
 protected:
  void SetUp() override {
    if (!dummy().opened) GTEST_SKIP() << "the library has no dummy device";
  }
  void TearDown() override {
    color_.stop();
    depth_.stop();
    wait_for_dummy();
  }

  /// Until the threads of the dummy have passed their last frames on.
  static void wait_for_dummy() { std::this_thread::sleep_for(std::chrono::milliseconds(200)); }

  static std::unique_ptr<FrameSource> open_dummy(std::optional<RgbdCamera> camera = dummy_camera()) {
    KinectOptions options;
    options.serial = kDummy;
    options.reconnect_s = 0;
    return open_openni2(options, camera);
  }
  static RgbdCamera dummy_camera() {
    RgbdCamera camera;
    camera.color.width = 320, camera.color.height = 240;
    camera.color.fx = camera.color.fy = 280, camera.color.cx = 159.5, camera.color.cy = 119.5;
    return camera;
  }

  openni::VideoStream &color_ = dummy().color, &depth_ = dummy().depth;
};

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST_F(OpenNi2Test, DeliversFramesInOrderWithTheDevicesStamps) {
  const auto source = open_dummy();
  EXPECT_TRUE(source->info().live);
  std::optional<RgbdFrame> before;
  for (int i = 0; i < 5; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->color.size(), cv::Size(320, 240));
    ASSERT_EQ(frame->depth_m.size(), cv::Size(320, 240));
    EXPECT_EQ(frame->depth_m.at<float>(0, 100), 2.0F);
    ASSERT_TRUE(frame->depth_stamp_ns);
    EXPECT_EQ(*frame->depth_stamp_ns, frame->stamp_ns) << "the dummy stamps both alike";
    if (before) {
      EXPECT_GT(frame->stamp_ns, before->stamp_ns);
      EXPECT_EQ((frame->stamp_ns - before->stamp_ns) % kDummyPeriod_ns, 0);
      EXPECT_FALSE(same(frame->depth_m, before->depth_m));
    }
    before = frame;
  }
}

TEST_F(OpenNi2Test, ARecordingOfTheLibraryHasTheLiveFrames) {
  const test::TempFolder folder;
  const std::string path = (folder.path() / "a.oni").string();
  std::vector<cv::Mat> live;
  {
    const auto source = open_dummy();
    openni::Recorder recorder;
    ASSERT_EQ(recorder.create(path.c_str()), openni::STATUS_OK);
    ASSERT_EQ(recorder.attach(color_), openni::STATUS_OK);
    ASSERT_EQ(recorder.attach(depth_), openni::STATUS_OK);
    color_.start();
    depth_.start();
    ASSERT_EQ(recorder.start(), openni::STATUS_OK);
    for (int i = 0; i < 12; ++i) {
      const auto frame = source->next();
      ASSERT_TRUE(frame);
      live.push_back(frame->depth_m);
    }
    // The library's recorder deadlocks if a frame arrives while it is destroyed.
    color_.stop();
    depth_.stop();
    wait_for_dummy();
    recorder.stop();
    recorder.destroy();
  }
  const auto recorded = open_oni_recording(path, dummy_camera());
  size_t frames = 0, matched = 0;
  auto from = live.begin();
  while (const auto frame = recorded->next()) {
    ++frames;
    const auto found =
        std::find_if(from, live.end(), [&](const cv::Mat& m) { return same(m, frame->depth_m); });
    if (found == live.end()) continue;
    ++matched;
    from = found + 1;
  }
  EXPECT_GE(matched, 5U) << "of " << frames << " recorded frames, in the order of " << live.size() << " live";
  EXPECT_LE(frames, recorded->info().frames);
  EXPECT_EQ(input_error([&] { open_oni_recording(path, {}); }).find(path), 0U)
      << "the dummy has no field of view";
}

TEST_F(OpenNi2Test, SaysWhatIsMissing) {
  EXPECT_THAT(input_error([] { open_dummy(std::nullopt); }),
              AllOf(HasSubstr("openni2"), HasSubstr("--camera")));
  RgbdCamera other = dummy_camera();
  other.color.width = 640;
  EXPECT_THAT(input_error([&] { open_dummy(other); }), HasSubstr("320 x 240"));
  KinectOptions absent;
  absent.serial = "no-such-device";
  EXPECT_THAT(input_error([&] { open_openni2(absent, {}); }), HasSubstr("no camera found at no-such-device"));
}

}  // namespace
}  // namespace kinloop

#else

namespace kinloop {
namespace {

TEST(OpenNi2, IsOffInThisBuild) {
  EXPECT_THAT(test::usage_error([] { open_openni2({}, {}); }), testing::HasSubstr("libopenni2-dev"));
  GTEST_SKIP() << "the rest needs libopenni2-dev";
}

}  // namespace
}  // namespace kinloop

#endif
