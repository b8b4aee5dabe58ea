#include "session/input/input_monitor.hpp"

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"
#include "session/session.hpp"
#include "simulator/simulated_source.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;

/// Frames in memory.
class FramesSource : public FrameSource {
 public:
  FramesSource(std::vector<Frame> frames, const RgbdCamera& camera, Trajectory truth = {},
               bool truth_in_metres = true)
      : frames_(std::move(frames)), camera_(camera) {
    info_.ground_truth = std::move(truth);
    info_.truth_in_metres = truth_in_metres;
  }

  std::optional<Frame> next() override {
    return next_ < frames_.size() ? std::optional(frames_[next_++]) : std::nullopt;
  }
  [[nodiscard]] const RgbdCamera& camera() const override { return camera_; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override { return {}; }

 private:
  std::vector<Frame> frames_;
  RgbdCamera camera_;
  SourceInfo info_;
  size_t next_ = 0;
};

/// Six seconds in a room, of a seed that is not in docs/lab/recordings.md.
const FramesSource& room() {
  static const FramesSource source = [] {
    SimulationOptions options;
    options.width = 320;
    options.height = 240;
    options.fps = 15;
    options.frames = 90;
    SimulatedSource simulated("sim:room", 43, options, 2);
    std::vector<Frame> frames;
    while (auto frame = simulated.next()) frames.push_back(*std::move(frame));
    return FramesSource(std::move(frames), simulated.camera(), simulated.info().ground_truth);
  }();
  return source;
}

/// What is said of a run whose camera has another focal length.
std::vector<InputWarning> warnings_with_focal_length(double factor) {
  FramesSource source = room();
  RgbdCamera camera = source.camera();
  camera.color.fx *= factor;
  camera.color.fy *= factor;
  SessionOptions options;
  options.record_images = false;
  Session session(source, options, camera, load_default_vocabulary());
  session.run();
  return session.input().warnings();
}

TEST(InputMonitor, SaysNothingOfACleanRun) {
  EXPECT_TRUE(warnings_with_focal_length(1).empty());
}

TEST(InputMonitor, EstimatesAFocalLengthThatIsTenPerCentOff) {
  const auto warnings = warnings_with_focal_length(1.1);
  ASSERT_EQ(warnings.size(), 1);
  EXPECT_EQ(warnings.front().fault, InputFault::kFocalLength);
  EXPECT_THAT(warnings.front().evidence, HasSubstr("the map fits 0.9"));
  EXPECT_THAT(warnings.front().remedy, HasSubstr("fx: 2"));
}

/// What is said of a run whose depth is 1.6 times too large, beside the poses of the recording.
std::vector<InputWarning> warnings_with_larger_depth(bool metric_depth, bool truth_in_metres) {
  constexpr double kFactor = 1.6;
  FramesSource source = room();
  std::vector<Frame> frames;
  while (auto frame = source.next()) {
    const cv::Mat larger = kFactor * frame->depth_m;  // not in place: other tests have the same image
    frame->depth_m = larger;
    frames.push_back(*std::move(frame));
  }
  RgbdCamera camera = source.camera();
  camera.sensor = depth_sensor(DepthSensorModel::kTimeOfFlight, SensorOrigin::kCameraFile);  // has no steps
  camera.depth_scale /= kFactor;
  camera.has_metric_depth = metric_depth;
  FramesSource larger(std::move(frames), camera, source.info().ground_truth, truth_in_metres);
  Session session(larger);
  session.run();
  return session.input().warnings();
}

TEST(InputMonitor, NamesADepthScaleThatContradictsThePosesOfTheRecording) {
  const auto warnings = warnings_with_larger_depth(false, true);
  ASSERT_EQ(warnings.size(), 1);
  EXPECT_EQ(warnings.front().fault, InputFault::kDepthUnit);
  EXPECT_THAT(warnings.front().evidence, HasSubstr("as large as in the poses"));
  EXPECT_THAT(warnings.front().remedy, HasSubstr("--depth-scale 5000 instead of 3125"));
}

TEST(InputMonitor, NamesNoDepthScaleOfDepthInMetres) {
  const auto warnings = warnings_with_larger_depth(true, true);
  ASSERT_EQ(warnings.size(), 1);
  EXPECT_THAT(warnings.front().remedy, HasSubstr("depth seems to be in another unit: divide it by 1."));
}

TEST(InputMonitor, DoesNotCompareWithPosesInAnArbitraryUnit) {
  EXPECT_TRUE(warnings_with_larger_depth(false, false).empty());
}

TEST(InputMonitor, EndsARunOfMirroredDepthEarly) {
  std::vector<Frame> frames;
  FramesSource source = room();
  while (auto frame = source.next()) {
    cv::Mat mirrored;
    cv::flip(frame->depth_m, mirrored, 1);
    frame->depth_m = mirrored;
    frames.push_back(*std::move(frame));
  }
  FramesSource mirrored(std::move(frames), source.camera());
  Session session(mirrored);
  EXPECT_THAT(test::input_error([&] { session.run(); }), HasSubstr("mirrored left to right"));
  EXPECT_LT(session.slam().session_log().size(), 30);
}

}  // namespace
}  // namespace kinloop
