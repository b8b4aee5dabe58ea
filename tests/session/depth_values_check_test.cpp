#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include <gmock/gmock.h>

#include "drivers/image_files/image_file.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "session/input/checks/checks.hpp"
#include "tests/session/contradictory_frames.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using test::CapturedFrames;
using test::with_depth;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr uint64_t kValuesSeed = 42;  // not one of docs/lab/recordings.md

const CapturedFrames& kinect_room() {
  static const CapturedFrames recording = test::simulated(SimulatedSensor::kKinect1, kValuesSeed, 12, 25);
  return recording;
}

/// Changes each depth that is known.
template <class Change>
test::DepthChange each(const Change& change) {
  return [change](const cv::Mat& depth_m) {
    cv::Mat changed = depth_m.clone();
    changed.forEach<float>([&](float& z_m, const int*) { z_m = z_m > 0 ? change(z_m) : 0; });
    return changed;
  };
}

DepthValuesCheck checked(const CapturedFrames& recording) {
  DepthValuesCheck check(recording.camera);
  for (const Frame& frame : recording.frames) check.observe(frame);
  return check;
}

std::string values_text(const CapturedFrames& recording) {
  const auto warning = checked(recording).values();
  return warning ? text_of(*warning) : "";
}

std::string unit_text(const CapturedFrames& recording) {
  const auto warning = checked(recording).unit();
  return warning ? text_of(*warning) : "";
}

/// The same files, read with a depth_scale that is wrong by the factor.
CapturedFrames with_wrong_scale(float factor) {
  CapturedFrames recording = with_depth(kinect_room(), each([=](float z_m) { return z_m / factor; }));
  recording.camera.depth_scale *= static_cast<double>(factor);
  return recording;
}

TEST(DepthValuesCheck, SaysNothingOfSensors) {
  EXPECT_EQ(values_text(kinect_room()), "");
  EXPECT_EQ(unit_text(kinect_room()), "");
  const CapturedFrames time_of_flight = test::simulated(SimulatedSensor::kKinect2, kValuesSeed, 6, 50);
  EXPECT_EQ(values_text(time_of_flight), "");
  EXPECT_EQ(unit_text(time_of_flight), "");
}

TEST(DepthValuesCheck, NamesConstantDepth) {
  EXPECT_THAT(values_text(with_depth(kinect_room(), each([](float) { return 2.F; }))),
              HasSubstr("depth is constant: 100 % of its pixels are at exactly 2.000 m"));
}

TEST(DepthValuesCheck, NamesTheLimitOfClippedDepth) {
  EXPECT_THAT(
      values_text(with_depth(kinect_room(), each([](float z_m) { return std::min(z_m, 1.8F); }))),
      AllOf(HasSubstr("depth is clipped"), HasSubstr("at exactly 1.800 m and hardly any is farther")));
  EXPECT_THAT(values_text(with_depth(kinect_room(), each([](float z_m) { return std::max(z_m, 1.5F); }))),
              HasSubstr("1.500 m and hardly any is nearer"));
}

/// As a Kinect 1 without its driver gives it: 1000 units of disparity per "metre".
float raw_kinect1(float z_m) {
  return 1e-3F * std::round(2842.5F * (std::atan(z_m / 0.1236F) - 1.1863F));
}

TEST(DepthValuesCheck, TheFirstFramesMayHaveNoDepth) {
  constexpr int kCovered = 10, kClipped = 30;  // times the recording
  const CapturedFrames clipped =
      with_depth(kinect_room(), each([](float z_m) { return std::min(z_m, 2.0F); }));
  const CapturedFrames covered = with_depth(clipped, each([](float) { return 0.0F; }));
  DepthValuesCheck check(clipped.camera);
  for (int i = 0; i < kCovered + kClipped; ++i) {
    for (const Frame& frame : (i < kCovered ? covered : clipped).frames) check.observe(frame);
  }
  const auto warning = check.values();
  ASSERT_TRUE(warning);
  EXPECT_THAT(warning->evidence, HasSubstr("at exactly 2.000 m"));
}

TEST(DepthValuesCheck, NamesRawDisparityOfAKinect1) {
  CapturedFrames raw = with_depth(kinect_room(), [](const cv::Mat& depth_m) {
    cv::Mat changed = depth_m.clone();
    changed.forEach<float>([](float& z_m, const int*) { z_m = z_m > 0 ? raw_kinect1(z_m) : 2.047F; });
    return changed;
  });
  raw.camera.depth_scale = 1000;
  EXPECT_THAT(values_text(raw), AllOf(HasSubstr("depth is the raw disparity of a Kinect 1"),
                                      HasSubstr("0.1236 tan(d / 2842.5 + 1.1863)")));
}

TEST(DepthValuesCheck, NamesCoarseSteps) {
  EXPECT_THAT(
      values_text(with_depth(kinect_room(), each([](float z_m) { return 0.2F * std::round(z_m / 0.2F); }))),
      HasSubstr("in steps of 0.2 m"));
}

TEST(DepthValuesCheck, NamesEightBitsInDisguise) {
  const auto bits = each([](float z_m) { return std::round(z_m / 8 * 255) / 255 * 8; });
  EXPECT_THAT(values_text(with_depth(kinect_room(), bits)), HasSubstr("in steps of 0.0314 m"));
}

TEST(DepthValuesCheck, NamesTheUnitByTheStepsOfAKinect) {
  EXPECT_THAT(unit_text(with_wrong_scale(5)),
              AllOf(HasSubstr("times too small"), HasSubstr("depth_scale: 5000 instead of 25000")));
  EXPECT_THAT(unit_text(with_wrong_scale(0.5)),
              AllOf(HasSubstr("times too large"), HasSubstr("depth_scale: 5000 instead of 2500")));
}

TEST(DepthValuesCheck, NamesNoDepthScaleOfDepthInMetres) {
  CapturedFrames recording = with_wrong_scale(5);
  recording.camera.has_metric_depth = true;
  EXPECT_THAT(unit_text(recording), AllOf(HasSubstr("multiply it by"), Not(HasSubstr("depth_scale"))));
}

/// What is said of the unit of depth images of a real Kinect, from every n-th of them.
std::string unit_text(const std::filesystem::path& folder, const RgbdCamera& camera, size_t every) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  DepthValuesCheck check(camera);
  for (size_t i = 0; i < files.size(); i += every) {
    Frame frame;
    frame.depth_m = read_depth_image(files[i], camera.depth_scale);
    check.observe(frame);
  }
  const auto warning = check.unit();
  return warning ? text_of(*warning) : "";
}

TEST(DepthValuesCheck, NamesTheUnitOfARealKinect) {
  const auto path = test::shared_data("redkitchen_raw/depth");
  KINLOOP_SKIP_WITHOUT(path);
  RgbdCamera camera;
  camera.depth_scale = 1000;
  EXPECT_EQ(unit_text(path, camera, 1), "");
  camera.depth_scale = 5000;
  EXPECT_THAT(unit_text(path, camera, 1), HasSubstr("depth_scale: 1000 instead of 5000"));
}

TEST(DepthValuesCheck, NamesTheUnitOfARealKinectThatAnotherProgramRegistered) {
  const auto path = test::shared_data("redkitchen/depth");
  KINLOOP_SKIP_WITHOUT(path);
  constexpr size_t kEvery = 20;
  RgbdCamera camera;
  camera.color = PinholeCamera{640, 480, 522, 522, 319, 238, {}};
  EXPECT_EQ(unit_text(path, camera, kEvery), "");
  camera.depth_scale = 2500;
  EXPECT_THAT(unit_text(path, camera, kEvery),
              AllOf(HasSubstr("2.0 times too large"), HasSubstr("depth_scale: 5000 instead of 2500")));
  camera.depth_scale = 25000;
  EXPECT_THAT(unit_text(path, camera, kEvery), HasSubstr("depth_scale: 5000 instead of 25000"));
  camera.color.fx = camera.color.fy = 615;  // of a RealSense, whose steps are half as large
  camera.depth_scale = 2500;
  EXPECT_EQ(unit_text(path, camera, kEvery), "");
}

TEST(DepthValuesCheck, SaysNothingOfTheUnitOfSensorsThatAreTakenForAKinect) {
  for (const SimulatedSensor sensor : {SimulatedSensor::kKinect2, SimulatedSensor::kRealsense}) {
    CapturedFrames recording = test::simulated(sensor, kValuesSeed, 6, 50);
    recording.camera.sensor = {};
    EXPECT_EQ(unit_text(recording), "");
  }
}

TEST(DepthValuesCheck, SaysNothingOfTheUnitOfDepthThatRegistrationEnlarges) {
  CapturedFrames recording = with_wrong_scale(0.5);
  recording.camera.depth = resized(recording.camera.color, recording.camera.color.width / 2);
  EXPECT_EQ(unit_text(recording), "");
}

TEST(DisparitySteps, AreNotTheSlopeOfAPlaneWithoutNoise) {
  // The inverse depth of a plane rises evenly along a row.
  cv::Mat depth_m(240, 320, CV_32FC1);
  for (int row = 0; row < depth_m.rows; ++row)
    for (int col = 0; col < depth_m.cols; ++col)
      depth_m.at<float>(row, col) = 1 / (0.25F + 0.0011F * static_cast<float>(col));
  DisparitySteps steps(0.0002);
  for (int i = 0; i < 10; ++i) steps.add(depth_m);
  EXPECT_FALSE(steps.per_m());
}

TEST(DisparitySteps, AreNotThoseOfCentimetres) {
  const auto centimetres = [](const cv::Mat& depth_m) {
    cv::Mat changed = depth_m.clone();
    changed.forEach<float>([](float& z_m, const int*) { z_m = 0.01F * std::round(100 * z_m); });
    return changed;
  };
  DisparitySteps steps(0.001);
  for (const Frame& frame : with_depth(kinect_room(), centimetres).frames) steps.add(frame.depth_m);
  EXPECT_FALSE(steps.per_m());
}

}  // namespace
}  // namespace kinloop
