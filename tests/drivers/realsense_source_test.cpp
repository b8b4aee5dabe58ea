#include "drivers/realsense/realsense_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

#ifdef KINLOOP_WITH_REALSENSE2

#include <algorithm>
#include <array>

#include <librealsense2/hpp/rs_internal.hpp>
#include <librealsense2/rsutil.h>
#include <opencv2/core.hpp>

#include "drivers/realsense/realsense_stream.hpp"
#include "drivers/ros/bag_source.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

constexpr int kColorWidth = 96, kColorHeight = 54, kDepthWidth = 80, kDepthHeight = 60;
constexpr double kPeriod_ms = 1000.0 / 30;

rs2_intrinsics color_lens(int width = kColorWidth) {
  const float scale = static_cast<float>(width) / kColorWidth;
  return {width,
          width * kColorHeight / kColorWidth,
          47.9F * scale,
          27.3F * scale,
          70 * scale,
          70.4F * scale,
          RS2_DISTORTION_INVERSE_BROWN_CONRADY,
          {-0.056F, 0.068F, 0.0003F, 0.0005F, -0.022F}};
}

rs2_intrinsics depth_lens() {
  return {kDepthWidth, kDepthHeight, 40.1F, 29.7F, 45, 45, RS2_DISTORTION_BROWN_CONRADY, {0, 0, 0, 0, 0}};
}

/// A turn by 0.02 rad about z, 15 mm aside.
constexpr rs2_extrinsics kPose = {{0.9998F, 0.02F, 0, -0.02F, 0.9998F, 0, 0, 0, 1}, {0.015F, 0, 0.001F}};

/// The SDK's software device with the streams of a D4xx, on two sensors or one.
class SoftwareCamera {
 public:
  explicit SoftwareCamera(bool one_sensor = false, const std::string& name = "Intel RealSense D435I")
      : depth_sensor_(device_.add_sensor("Stereo Module")),
        color_sensor_(one_sensor ? depth_sensor_ : device_.add_sensor("RGB Camera")) {
    device_.register_info(RS2_CAMERA_INFO_NAME, name);
    device_.register_info(RS2_CAMERA_INFO_SERIAL_NUMBER, "7001");
    depth_sensor_.add_read_only_option(RS2_OPTION_DEPTH_UNITS, 0.001F);
    depth_ = depth_sensor_.add_video_stream(
        {RS2_STREAM_DEPTH, 0, 1, kDepthWidth, kDepthHeight, 30, 2, RS2_FORMAT_Z16, depth_lens()});
    color_ = add_color(2, kColorWidth, 30);
    add_color(3, 2 * kColorWidth, 30);
    add_color(4, kColorWidth, 15);
  }

  rs2::software_device& device() { return device_; }
  rs2::stream_profile& color_profile() { return color_; }
  rs2::stream_profile& depth_profile() { return depth_; }

  std::unique_ptr<FrameSource> open(const std::optional<RgbdCamera>& camera = {}) {
    KinectOptions options;
    options.width = kColorWidth + 10;
    options.reconnect_s = 0;
    return open_realsense([this] { return device_; }, options, camera);
  }

  /// Frame `i`: depth of a plane at 1.5 m, half a millisecond after colour of the value `i`.
  void send(int i, double start_ms = 1000, rs2_timestamp_domain domain = RS2_TIMESTAMP_DOMAIN_GLOBAL_TIME) {
    const double stamp_ms = start_ms + i * kPeriod_ms;
    color_pixels_.fill(static_cast<uint8_t>(i));
    depth_pixels_.fill(1500);
    color_sensor_.on_video_frame(
        {color_pixels_.data(), [](void*) {}, 3 * kColorWidth, 3, stamp_ms, domain, i, color_.get(), 0});
    depth_sensor_.on_video_frame({depth_pixels_.data(), [](void*) {}, 2 * kDepthWidth, 2, stamp_ms + 0.5,
                                  domain, i, depth_.get(), 0.001F});
  }

 private:
  rs2::stream_profile add_color(int id, int width, int fps) {
    const rs2_intrinsics lens = color_lens(width);
    auto profile = color_sensor_.add_video_stream(
        {RS2_STREAM_COLOR, 0, id, lens.width, lens.height, fps, 3, RS2_FORMAT_BGR8, lens});
    depth_.register_extrinsics_to(profile, kPose);
    return profile;
  }

  rs2::software_device device_;
  rs2::software_sensor depth_sensor_, color_sensor_;
  rs2::stream_profile color_, depth_;
  std::array<uint8_t, 3 * kColorWidth * kColorHeight> color_pixels_{};
  std::array<uint16_t, kDepthWidth * kDepthHeight> depth_pixels_{};
};

std::vector<Frame> take(FrameSource& source, int count) {
  std::vector<Frame> frames;
  for (int i = 0; i < count; ++i) {
    auto frame = source.next();
    if (!frame) break;
    frames.push_back(std::move(*frame));
  }
  return frames;
}

TEST(Realsense, ProjectsAsTheSdk) {
  SoftwareCamera sdk;
  const RgbdCamera camera = sdk.open()->camera();
  ASSERT_TRUE(camera.depth);
  EXPECT_EQ(camera.fps, 30);
  EXPECT_EQ(camera.sensor.model, DepthSensorModel::kRealsenseD4xx);
  const rs2_intrinsics color = color_lens(), depth = depth_lens();
  for (const std::array<float, 2>& pixel : {std::array{0.0F, 0.0F}, {79, 0}, {40, 30}, {3, 59}, {70, 50}}) {
    std::array<float, 3> point{}, in_color{};
    std::array<float, 2> seen{};
    rs2_deproject_pixel_to_point(point.data(), &depth, pixel.data(), 1.2F);
    rs2_transform_point_to_point(in_color.data(), &kPose, point.data());
    rs2_project_point_to_pixel(seen.data(), &color, in_color.data());
    const Eigen::Vector3d ours = camera.depth->unproject({pixel[0], pixel[1]}, 1.2);
    const Eigen::Vector2d ideal = camera.color.project(camera.T_color_depth * ours);
    EXPECT_LT((camera.color.distort(ideal) - Eigen::Vector2d(seen[0], seen[1])).norm(), 0.02);
  }
}

TEST(Realsense, FramesHaveRegisteredDepthAndBothStamps) {
  SoftwareCamera sdk;
  const auto source = sdk.open();
  for (int i = 0; i < 4; ++i) sdk.send(i);
  const auto frames = take(*source, 3);
  ASSERT_EQ(frames.size(), 3U);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].color.size(), cv::Size(kColorWidth, kColorHeight));
    EXPECT_EQ(frames[i].color.bgr().at<cv::Vec3b>(5, 7), cv::Vec3b::all(static_cast<uint8_t>(i)));
    EXPECT_EQ(frames[i].depth_m.size(), cv::Size(kColorWidth, kColorHeight));
    EXPECT_NEAR(frames[i].depth_m.at<float>(27, 48), 1.501, 1e-6) << "colour is 1 mm behind depth";
    EXPECT_EQ(frames[i].depth_stamp_or_color_ns() - frames[i].stamp_ns, 500'000);
  }
  EXPECT_NEAR(static_cast<double>(frames[2].stamp_ns - frames[0].stamp_ns), 2e6 * kPeriod_ms, 2e3);
}

TEST(Realsense, FollowsTheDevicesCounterAcrossItsWrapAround) {
  SoftwareCamera sdk;
  const auto source = sdk.open();
  constexpr double kWrap_ms = 4294967.296;
  for (int i = 0; i < 4; ++i) {
    const double start_ms = kWrap_ms - 50 - (i < 2 ? 0 : kWrap_ms);
    sdk.send(i, start_ms, RS2_TIMESTAMP_DOMAIN_HARDWARE_CLOCK);
  }
  const auto frames = take(*source, 3);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_NEAR(static_cast<double>(frames[2].stamp_ns - frames[1].stamp_ns), 1e6 * kPeriod_ms, 2e3);
}

TEST(Realsense, OneSensorMaySendBothStreams) {
  SoftwareCamera sdk(true, "Intel RealSense L515");
  const auto source = sdk.open();
  EXPECT_EQ(source->camera().sensor.model, DepthSensorModel::kRealsenseL515);
  for (int i = 0; i < 3; ++i) sdk.send(i);
  EXPECT_EQ(take(*source, 2).size(), 2U);
}

TEST(Realsense, TheModeIsThatOfTheCalibration) {
  SoftwareCamera sdk;
  RgbdCamera wide = sdk.open()->camera();
  wide.color = resized(wide.color, 2 * kColorWidth);
  EXPECT_EQ(sdk.open(wide)->camera().color.width, 2 * kColorWidth);
  wide.color.width = 500;
  EXPECT_THAT(input_error([&] { sdk.open(wide); }), HasSubstr("192 x 108"));
}

TEST(Realsense, EndsAndIsOpenedAgain) {
  SoftwareCamera sdk;
  {
    const auto source = sdk.open();
    for (int i = 0; i < 3; ++i) sdk.send(i);
    EXPECT_EQ(take(*source, 10).size(), 2U) << "the last depth image could still be nearer to a later frame";
  }
  const auto again = sdk.open();
  for (int i = 0; i < 3; ++i) sdk.send(i);
  EXPECT_EQ(take(*again, 1).size(), 1U);
}

TEST(Realsense, SaysWhatIsMissing) {
  EXPECT_THAT(input_error([] { open_realsense(KinectOptions(), {}); }),
              AllOf(HasSubstr("no camera found"), HasSubstr("udev")));
}

/// The SDK writes a bag, which kinloop reads without it.
TEST(Realsense, ARecordingOfTheSdkHasTheLiveFrames) {
  const test::TempFolder folder;
  const std::string path = (folder.path() / "a.bag").string();
  constexpr int kFrames = 6;
  {
    SoftwareCamera sdk;
    const rs2::recorder recorder(path, sdk.device());
    auto sensors = recorder.query_sensors();
    ASSERT_EQ(sensors.size(), 2U);
    sensors[0].open(sdk.depth_profile());
    sensors[1].open(sdk.color_profile());
    for (const rs2::sensor& sensor : sensors) sensor.start([](const rs2::frame&) {});
    for (int i = 0; i < kFrames; ++i) sdk.send(i);
    for (const rs2::sensor& sensor : sensors) sensor.stop(), sensor.close();
  }
  SoftwareCamera sdk;
  const auto live = sdk.open();
  const auto recorded = open_bag(path, {});
  EXPECT_EQ(recorded->camera().color, live->camera().color);
  EXPECT_EQ(recorded->camera().depth, live->camera().depth);
  for (int i = 0; i < kFrames; ++i) sdk.send(i);
  const auto from_bag = take(*recorded, kFrames);
  ASSERT_GE(from_bag.size(), 4U);
  const auto from_camera = take(*live, 1);
  ASSERT_EQ(from_camera.size(), 1U);
  for (const Frame& frame : from_bag) {
    EXPECT_EQ(frame.depth_stamp_or_color_ns() - frame.stamp_ns, 500'000);
    EXPECT_LT(cv::norm(frame.depth_m, from_camera[0].depth_m, cv::NORM_INF), 1e-6);
  }
}

}  // namespace
}  // namespace kinloop

#else

namespace kinloop {
namespace {

TEST(Realsense, IsOffInThisBuild) {
  EXPECT_THAT(test::usage_error([] { open_realsense(KinectOptions(), {}); }),
              testing::HasSubstr("librealsense2"));
  GTEST_SKIP() << "the rest needs librealsense2";
}

}  // namespace
}  // namespace kinloop

#endif
