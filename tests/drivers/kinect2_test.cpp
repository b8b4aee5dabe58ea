#include <cmath>
#include <deque>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/kinect2/kinect2_source.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

#ifdef KINLOOP_WITH_FREENECT2

#include <libfreenect2/logger.h>
#include <libfreenect2/packet_pipeline.h>
#include <libfreenect2/registration.h>
#include <opencv2/core.hpp>

#include "drivers/kinect2/kinect2_factory.hpp"
#include "drivers/kinect2/kinect2_packets.hpp"
#include "drivers/kinect2/kinect2_stream.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "tests/drivers/fake_kinect2.hpp"

namespace kinloop {
namespace {

using libfreenect2::Frame;
using std::chrono::milliseconds;
using test::color_params;
using test::infrared_params;
using testing::HasSubstr;

TEST(Kinect2, TheFactorysPolynomialBecomesARigidMotion) {
  const RgbdCamera camera = factory_camera(color_params(52), infrared_params());
  // Unmirrored, the colour camera is on the other side of the depth camera.
  EXPECT_LT((camera.T_color_depth.translation - Eigen::Vector3d(-0.052, 0, 0)).norm(), 5e-4);
  EXPECT_LT(camera.T_color_depth.angle_rad(), 5e-4);
  EXPECT_EQ(camera.color.width, 1920);
  EXPECT_NEAR(camera.color.cx, 959.5, 1e-3);
  EXPECT_NEAR(camera.depth->cx, 511 - 257, 1e-3);
}

/// A smooth scene with a step, as seen by the depth camera, mm.
cv::Mat scene_mm() {
  cv::Mat depth(424, 512, CV_32FC1);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      depth.at<float>(y, x) =
          x > 180 && x < 330 && y > 120 && y < 300 ? 1200.0F : 2000.0F + 1.5F * static_cast<float>(y);
    }
  }
  return depth;
}

TEST(Kinect2, RegistrationAgreesWithLibfreenect2) {
  cv::Mat mirrored = scene_mm(), color(1080, 1920, CV_8UC4, cv::Scalar(0));
  Frame depth(512, 424, 4, mirrored.data), rgb(1920, 1080, 4, color.data);
  Frame undistorted(512, 424, 4), registered(512, 424, 4), big(1920, 1082, 4);
  const libfreenect2::Registration theirs(infrared_params(), color_params(52));
  theirs.apply(&rgb, &depth, &undistorted, &registered, true, &big);
  // Its large image has one more row than colour at the top and at the bottom.
  cv::Mat their_depth = cv::Mat(1082, 1920, CV_32FC1, big.data).rowRange(1, 1081) / 1000;
  cv::flip(their_depth, their_depth, 1);

  cv::Mat straight;
  cv::flip(mirrored / 1000, straight, 1);
  const cv::Mat ours = DepthRegistration(factory_camera(color_params(52), infrared_params()))(straight);
  int both = 0, agree = 0;
  for (int y = 0; y < ours.rows; ++y) {
    for (int x = 0; x < ours.cols; ++x) {
      const float a = ours.at<float>(y, x), b = their_depth.at<float>(y, x);
      if (!(a > 0) || !(b > 0) || std::isinf(b)) continue;
      ++both;
      agree += std::abs(a - b) < 0.01F ? 1 : 0;
    }
  }
  EXPECT_GT(both, 0.6 * 1920 * 1080);
  EXPECT_GT(agree, 0.98 * both);
}

TEST(Kinect2Listener, UnmirrorsFramesAndCountsFaultyOnes) {
  LiveFrameBuffer frames;
  Kinect2Listener listener(frames, 960);
  Frame color(1920, 1080, 4), depth(512, 424, 4);
  color.format = Frame::BGRX;
  cv::Mat color_pixels(1080, 1920, CV_8UC4, color.data), depth_pixels(424, 512, CV_32FC1, depth.data);
  color_pixels.setTo(cv::Scalar(0, 0, 0, 0));
  color_pixels.colRange(0, 960).setTo(cv::Scalar(10, 20, 30, 0));
  depth_pixels.setTo(1500);
  depth_pixels.col(0).setTo(std::numeric_limits<float>::quiet_NaN());
  depth_pixels.col(1).setTo(-1);
  color.timestamp = depth.timestamp = 0xffffff00U;
  color.status = depth.status = 0;
  EXPECT_FALSE(listener.onNewFrame(Frame::Color, &color)) << "libfreenect2 keeps the frame";
  listener.onNewFrame(Frame::Depth, &depth);
  const auto frame = frames.wait(milliseconds(10));
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->color.size(), cv::Size(960, 540));
  EXPECT_EQ(frame->color.bgr().at<cv::Vec3b>(100, 900), cv::Vec3b(10, 20, 30));
  EXPECT_EQ(frame->color.bgr().at<cv::Vec3b>(100, 50), cv::Vec3b(0, 0, 0));
  EXPECT_FLOAT_EQ(frame->depth_m.at<float>(7, 0), 1.5F);
  EXPECT_EQ(frame->depth_m.at<float>(7, 511), 0);
  EXPECT_EQ(frame->depth_m.at<float>(7, 510), 0);

  color.timestamp = depth.timestamp = 10;  // 266 ticks of 0.125 ms later, past the counter's wrap-around
  listener.onNewFrame(Frame::Depth, &depth);
  listener.onNewFrame(Frame::Color, &color);
  const auto later = frames.wait(milliseconds(10));
  ASSERT_TRUE(later);
  EXPECT_EQ(later->stamp_ns - frame->stamp_ns, 266 * 125'000);
  depth.status = 1;
  listener.onNewFrame(Frame::Depth, &depth);
  EXPECT_EQ(listener.faulty(), 1U);
}

TEST(Kinect2Source, GivesBothCamerasApartForCalibration) {
  const auto fake = std::make_shared<test::FakeKinect2>([](libfreenect2::FrameListener& to) {
    Frame color(1920, 1080, 4), infrared(512, 424, 4), depth(512, 424, 4);
    cv::Mat(1080, 1920, CV_8UC4, color.data).setTo(cv::Scalar::all(9));
    cv::Mat(424, 512, CV_32FC1, depth.data).setTo(1500);
    cv::Mat brightness(424, 512, CV_32FC1, infrared.data);
    brightness.setTo(700);
    brightness.col(0).setTo(65535);
    color.format = Frame::BGRX;
    color.timestamp = infrared.timestamp = depth.timestamp = 77;
    color.status = infrared.status = depth.status = 0;
    to.onNewFrame(Frame::Ir, &infrared);
    to.onNewFrame(Frame::Depth, &depth);
    to.onNewFrame(Frame::Color, &color);
  });
  KinectOptions options;
  options.width = 1920;
  Kinect2Source source(
      [&] {
        return Kinect2Handle{fake, fake.get()};
      },
      options, {}, Kinect2Frames::kSeparate);
  const auto frame = source.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->color.size(), cv::Size(1920, 1080));
  ASSERT_EQ(frame->infrared.type(), CV_16UC1);
  EXPECT_EQ(frame->infrared.at<uint16_t>(5, 5), 700);
  EXPECT_EQ(frame->infrared.at<uint16_t>(5, 511), 65535) << "unmirrored, as depth";
  EXPECT_EQ(frame->depth_m.size(), cv::Size(512, 424)) << "not registered";
  ASSERT_TRUE(source.camera().depth);
  EXPECT_EQ(source.camera().depth->width, 512);
}

/// libfreenect2's replay takes the time stamp from the beginning of the path, so the packets must be in the
/// working folder.
class Kinect2Replay : public testing::Test {
 protected:
  Kinect2Replay() : before_(std::filesystem::current_path()) {
    std::filesystem::current_path(folder_.path());
  }
  ~Kinect2Replay() override { std::filesystem::current_path(before_); }

  /// A raw depth packet, ten images of 11 bits per pixel, at device time `ticks`.
  [[nodiscard]] std::string packet(uint32_t ticks) const {
    constexpr size_t kBytes = 10 * 512 * 424 * 11 / 8;
    std::string bytes(kBytes, '\0');
    for (size_t i = 0; i < kBytes; ++i) bytes[i] = static_cast<char>(i * 2654435761U >> 24);
    const std::string name = std::to_string(ticks) + "_packet_1.depth";
    folder_.write(name, bytes);
    return name;
  }

  /// A device that sends one colour image and the replay's depth image of the same time.
  [[nodiscard]] Kinect2Handle device(uint32_t ticks) const {
    const auto fake = std::make_shared<test::FakeKinect2>([this, ticks](libfreenect2::FrameListener& to) {
      Frame color(1920, 1080, 4);
      cv::Mat(1080, 1920, CV_8UC4, color.data).setTo(cv::Scalar(10, 20, 30, 0));
      color.format = Frame::BGRX;
      color.timestamp = ticks;
      color.status = 0;
      to.onNewFrame(Frame::Color, &color);
      EXPECT_TRUE(test::replay_packet(packet(ticks), to));
    });
    return {fake, fake.get()};
  }

  test::TempFolder folder_;
  std::filesystem::path before_;
};

TEST_F(Kinect2Replay, SurvivesUnpluggingAndReplugging) {
  libfreenect2::setGlobalLogger(nullptr);
  // After plugging in again, a device's clock restarts.
  std::deque<uint32_t> plugged_in = {500'000, 1266};
  const auto open = [&]() -> Kinect2Handle {
    if (plugged_in.empty()) throw InputError("unplugged");
    const uint32_t ticks = plugged_in.front();
    plugged_in.pop_front();
    return device(ticks);
  };
  KinectOptions options;
  options.reconnect_s = 0.1;
  Kinect2Source source(open, options, {});
  EXPECT_EQ(source.camera().color.width, 960);
  EXPECT_EQ(source.camera().sensor.model, DepthSensorModel::kKinect2);
  EXPECT_TRUE(source.info().live);
  const auto first = source.next(), second = source.next();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->color.size(), cv::Size(960, 540));
  EXPECT_EQ(first->depth_m.size(), cv::Size(960, 540));
  EXPECT_GT(second->stamp_ns, first->stamp_ns);
  EXPECT_FALSE(source.next()) << "it does not return a second time";
  EXPECT_THAT(source.skipped(), testing::IsEmpty());
}

TEST_F(Kinect2Replay, PlaysWhatWasRecordedRaw) {
  libfreenect2::setGlobalLogger(nullptr);
  const std::string bytes = read_file(packet(1));
  std::string jpeg = "\xff\xd8 as the camera compressed it";
  const auto give = [&](libfreenect2::FrameListener& to, Frame::Type type, std::string& data, uint32_t ticks,
                        uint32_t number) {
    Frame frame(1, 1, data.size(), reinterpret_cast<unsigned char*>(data.data()));
    frame.format = Frame::Raw;
    frame.timestamp = ticks;
    frame.sequence = number;
    EXPECT_FALSE(to.onNewFrame(type, &frame));
  };
  const auto fake = std::make_shared<test::FakeKinect2>([&](libfreenect2::FrameListener& to) {
    std::string depth = bytes;
    give(to, Frame::Ir, depth, 1000, 7);  // the dump pipeline sends each depth packet twice
    give(to, Frame::Depth, depth, 1000, 7);
    give(to, Frame::Color, jpeg, 1003, 40);
    give(to, Frame::Depth, depth, 1533, 9);
  });
  const RawPacketCounts recording =
      record_packets({fake, fake.get()}, {}, "raw", [](const RawPacketCounts& r) { return r.depth == 2; });
  EXPECT_EQ(recording.depth, 2U);
  EXPECT_EQ(recording.color, 1U);
  EXPECT_EQ(recording.lost, 1U);
  EXPECT_EQ(read_file("raw/1003_packet_40.jpg"), jpeg);
  EXPECT_EQ(read_file("raw/1533_packet_9.depth"), bytes);
  EXPECT_THAT(read_file("raw/parameters.yaml"), HasSubstr("infrared: {fx: 365"));
  EXPECT_TRUE(read_camera_file("raw/camera.yaml").depth);

  std::filesystem::current_path("raw");
  LiveFrameBuffer frames;
  Kinect2Listener listener(frames, 960);
  EXPECT_TRUE(test::replay_packet("1000_packet_7.depth", listener)) << "decoded by libfreenect2's replay";
}

TEST_F(Kinect2Replay, RawRecordingSaysWhatCannotBeWritten) {
  folder_.write("occupied", "a file");
  const auto fake = std::make_shared<test::FakeKinect2>([](libfreenect2::FrameListener&) {});
  EXPECT_THAT(test::input_error([&] {
                record_packets({fake, fake.get()}, {}, "occupied", [](const auto&) { return true; });
              }),
              HasSubstr("occupied"));
  EXPECT_THAT(test::input_error([] { record_kinect2_raw({}, "raw", [](const auto&) { return true; }); }),
              HasSubstr("no Kinect 2 found"));
}

TEST(Kinect2, ReportsThatNoneIsConnected) {
  EXPECT_THAT(test::input_error([] { open_kinect2({}, {}); }), HasSubstr("no Kinect 2 found"));
}

}  // namespace
}  // namespace kinloop

#else

TEST(Kinect2, IsReportedAsMissingFromTheBuild) {
  EXPECT_FALSE(kinloop::kinect2_available());
  EXPECT_THAT(kinloop::test::usage_error([] { kinloop::open_kinect2({}, {}); }),
              testing::HasSubstr("libfreenect2"));
}

#endif
