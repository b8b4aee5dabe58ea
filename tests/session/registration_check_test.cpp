#include <algorithm>
#include <filesystem>

#include <gmock/gmock.h>

#include "drivers/image_files/image_file.hpp"
#include "session/input/checks/checks.hpp"
#include "tests/session/contradictory_frames.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using test::CapturedFrames;
using test::flipped;
using test::resized;
using test::warning_text;
using test::with_depth;
using testing::AllOf;
using testing::HasSubstr;

/// The seeds are not those of docs/lab/recordings.md, on which the thresholds were chosen.
constexpr uint64_t kSeed = 41;

const CapturedFrames& room() {
  static const CapturedFrames recording = test::simulated(SimulatedSensor::kKinect1, kSeed, 14, 25);
  return recording;
}

/// The colour and depth images of a folder, in order of their names.
CapturedFrames folder(const std::filesystem::path& path, double depth_scale) {
  const auto files = [&](const char* name) {
    std::vector<std::filesystem::path> all;
    for (const auto& entry : std::filesystem::directory_iterator(path / name)) all.push_back(entry.path());
    std::sort(all.begin(), all.end());
    return all;
  };
  CapturedFrames recording;
  recording.camera.color = {640, 480, 522.07, 522.07, 319.07, 237.69, {}};
  const auto colors = files("rgb"), depths = files("depth");
  for (size_t i = 0; i < colors.size(); ++i) {
    Frame frame;
    frame.color = read_color_image(colors[i]);
    frame.depth_m = read_depth_image(depths[i], depth_scale);
    recording.frames.push_back(frame);
  }
  return recording;
}

TEST(RegistrationCheck, SaysNothingOfRegisteredDepth) {
  EXPECT_EQ(warning_text(room()), "");
  EXPECT_EQ(warning_text(test::simulated(SimulatedSensor::kRealsense, kSeed, 14, 25)), "");
}

TEST(RegistrationCheck, IsSureThatDepthIsRegistered) {
  InputChecker checker(room().camera, FrameOrder::kSpread);
  for (const Frame& frame : room().frames) checker.observe(frame);
  const auto alignment = checker.alignment();
  ASSERT_TRUE(alignment);
  EXPECT_EQ(judge_registration(*alignment), Registration::kRegistered);
}

TEST(RegistrationCheck, NamesMirroredDepthAndIsCertain) {
  EXPECT_THAT(warning_text(with_depth(room(), flipped(1))), HasSubstr("mirrored left to right"));
  EXPECT_THAT(warning_text(with_depth(room(), flipped(0))), HasSubstr("upside down"));
  EXPECT_THAT(warning_text(with_depth(room(), flipped(-1))), HasSubstr("turned by 180 degrees"));
  const auto found = test::warnings(with_depth(room(), flipped(1)));
  ASSERT_EQ(found.size(), 1);
  EXPECT_TRUE(found.front().hopeless);
}

TEST(RegistrationCheck, MeasuresTheScaleOfDepthThatWasOnlyResized) {
  InputChecker checker(room().camera, FrameOrder::kSpread);
  for (const Frame& frame : with_depth(room(), resized(0.6, 0.8)).frames) checker.observe(frame);
  const auto alignment = checker.alignment();
  ASSERT_TRUE(alignment);
  EXPECT_NEAR(alignment->best.scale.x(), 1 / 0.6, 0.05);
  EXPECT_NEAR(alignment->best.scale.y(), 1 / 0.8, 0.05);
}

TEST(RegistrationCheck, NamesScaleAndDepthCamera) {
  EXPECT_THAT(warning_text(with_depth(room(), resized(0.7, 0.7))),
              AllOf(HasSubstr("not registered to colour: it fits if enlarged 1.4"),
                    HasSubstr("depth: {fx: 1"), HasSubstr("T_color_depth")));
}

TEST(RegistrationCheck, NamesTheShift) {
  EXPECT_THAT(warning_text(with_depth(room(), resized(1, 1, 0.05))), HasSubstr("it fits if moved by 1"));
}

TEST(RegistrationCheck, SaysNothingWithoutEdges) {
  const auto flat = [](const cv::Mat& depth_m) { return cv::Mat(depth_m.size(), CV_32FC1, cv::Scalar(2)); };
  InputChecker checker(room().camera, FrameOrder::kSpread);
  for (const Frame& frame : with_depth(room(), flat).frames) checker.observe(frame);
  EXPECT_FALSE(checker.alignment());
}

TEST(RegistrationCheck, FindsTheDepthCameraOfARealKinect) {
  const auto path = test::shared_data("redkitchen_raw");
  KINLOOP_SKIP_WITHOUT(path);
  InputChecker checker({}, FrameOrder::kSpread);
  for (const Frame& frame : folder(path, 1000).frames) checker.observe(frame);
  const auto alignment = checker.alignment();
  ASSERT_TRUE(alignment);
  EXPECT_EQ(judge_registration(*alignment), Registration::kScaled);
  EXPECT_NEAR(alignment->best.scale.x(), 522.07 / 585, 0.03);
  EXPECT_NEAR(alignment->best.scale.y(), 522.07 / 585, 0.06);
}

}  // namespace
}  // namespace kinloop
