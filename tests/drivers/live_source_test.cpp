#include "drivers/live/live_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "drivers/live/device_selection.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

constexpr int64_t kPeriod_ns = 33'000'000;

/// A camera of 64 x 48 pixels; with a depth camera of half the size, 10 cm to the left.
RgbdCamera camera(bool separate_depth) {
  RgbdCamera camera;
  camera.color.width = 64, camera.color.height = 48;
  camera.color.fx = camera.color.fy = 50, camera.color.cx = 31.5, camera.color.cy = 23.5;
  camera.sensor.set_by_source(DepthSensorModel::kStereo);
  if (!separate_depth) return camera;
  camera.depth = camera.color;
  camera.depth->width = 32, camera.depth->height = 24;
  camera.depth->fx = camera.depth->fy = 25, camera.depth->cx = 15.5, camera.depth->cy = 11.5;
  camera.T_color_depth.translation = {-0.1, 0, 0};
  return camera;
}

/// A device that sends one frame of a plane at 2 m.
LiveCamera fake(bool separate_depth) {
  return {"fake", [separate_depth](LiveFrameBuffer& frames) {
            const RgbdCamera known = camera(separate_depth);
            const PinholeCamera& depth = separate_depth ? *known.depth : known.color;
            frames.add_depth(kPeriod_ns + 4'000'000, {depth.height, depth.width, CV_32FC1, cv::Scalar(2)});
            frames.add_color(kPeriod_ns, cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(9)));
            frames.finish();
            return LiveDevice{known, std::make_shared<int>(0)};
          }};
}

TEST(LiveSource, RegistersDepthToColour) {
  const auto source = open_live(fake(true), {});
  EXPECT_TRUE(source->info().live);
  EXPECT_EQ(source->info().name, "fake");
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  ASSERT_EQ(frame->depth_m.size(), cv::Size(64, 48));
  EXPECT_EQ(frame->stamp_ns, kPeriod_ns);
  EXPECT_EQ(frame->depth_stamp_ns, kPeriod_ns + 4'000'000);
  // 10 cm at 2 m are 2.5 px to the left: the columns at the right are not seen by the depth camera.
  EXPECT_FLOAT_EQ(frame->depth_m.at<float>(20, 5), 2);
  EXPECT_EQ(frame->depth_m.at<float>(20, 62), 0);
}

TEST(LiveSource, ACalibrationReplacesTheCameraOfTheDevice) {
  RgbdCamera calibration = camera(false);
  calibration.color.fx = 51;
  calibration.depth_shift_m = 0.25;
  calibration.sensor = {};
  const auto source = open_live(fake(false), calibration);
  EXPECT_EQ(source->camera().color.fx, 51);
  EXPECT_EQ(source->camera().sensor.model, DepthSensorModel::kStereo) << "known by the device";
  const auto frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_FLOAT_EQ(frame->depth_m.at<float>(0, 0), 2.25F);

  calibration.sensor = depth_sensor(DepthSensorModel::kIphone, SensorOrigin::kCameraFile);
  EXPECT_EQ(open_live(fake(false), calibration)->camera().sensor.model, DepthSensorModel::kIphone);
}

TEST(LiveSource, RefusesACalibrationThatDoesNotFit) {
  RgbdCamera other = camera(true);
  other.color.width = 640;
  EXPECT_THAT(input_error([&] { open_live(fake(true), other); }),
              AllOf(HasSubstr("colour of 64 x 48"), HasSubstr("640 x 48")));
  other = camera(true);
  other.depth->height = 25;
  EXPECT_THAT(input_error([&] { open_live(fake(true), other); }), HasSubstr("depth of 32 x 24"));
  EXPECT_THAT(input_error([&] { open_live(fake(true), camera(false)); }), HasSubstr("no 'depth' camera"));
  EXPECT_FALSE(open_live(fake(false), camera(true))->camera().depth) << "the device registers depth";
}

TEST(LiveSource, EndsIfTheCameraDoesNotReturn) {
  int opened = 0;
  LiveCamera camera_once = fake(false);
  const auto source = open_live({"fake",
                                 [&](LiveFrameBuffer& frames) {
                                   if (++opened > 1) throw InputError("fake: no camera found");
                                   return camera_once.open(frames);
                                 }},
                                {});
  EXPECT_TRUE(source->next());
  EXPECT_FALSE(source->next());
}

TEST(DeviceSelection, FindsTheDeviceOrListsWhatIsThere) {
  EXPECT_EQ(choose_device("fake", {"7", "8"}, "", "rules"), 0U);
  EXPECT_EQ(choose_device("fake", {"7", "8"}, "8", "rules"), 1U);
  EXPECT_THAT(input_error([] {
                choose_device("fake", {"7", "8"}, "9", "rules");
              }),
              AllOf(HasSubstr("number 9"), HasSubstr("there are: 7, 8")));
  EXPECT_THAT(input_error([] { choose_device("fake", {}, "9", "rules"); }),
              AllOf(HasSubstr("no camera found"), HasSubstr("rules")));
}

TEST(DeviceSelection, PrefersTheRateThenTheWidthThenRows) {
  const StreamMode best{960, 540, 30};
  for (const StreamMode& other : {StreamMode{960, 540, 60}, {1280, 720, 30}, {640, 480, 30}, {960, 480, 30}})
    EXPECT_LT(mode_distance(best, 960), mode_distance(other, 960));
}

}  // namespace
}  // namespace kinloop
