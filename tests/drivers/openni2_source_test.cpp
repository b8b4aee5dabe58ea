#include "drivers/openni2/openni2_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

#ifdef KINLOOP_WITH_OPENNI2

#include <chrono>
#include <thread>

#include <opencv2/core.hpp>
#include <openni2/OpenNI.h>

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
  /// Waits until the threads of the dummy have passed their last frames on.
  void TearDown() override { std::this_thread::sleep_for(std::chrono::milliseconds(200)); }

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
};

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST_F(OpenNi2Test, DeliversFramesInOrderWithTheDevicesStamps) {
  const auto source = open_dummy();
  EXPECT_TRUE(source->info().live);
  std::optional<Frame> before;
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
