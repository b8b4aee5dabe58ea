// Whole short sequences through Slam: accuracy, the effect of a loop closure, and self-calibration.

#include <gtest/gtest.h>

#include "session/session.hpp"
#include "simulator/simulated_source.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

/// A short version of the built-in walk: few and small images, with a revisit at the end.
SimulationOptions small_walk() {
  SimulationOptions options;
  options.width = 320;
  options.height = 240;
  options.fps = 10;
  return options;
}

struct FinishedRun {
  double ate_m = 0;
  size_t frames = 0, tracked = 0, loops = 0;
  SensorEstimate sensor;
  SensorGroundTruth truth;
};

/// Takes the stamps of depth from the frames of another source.
class WithoutDepthStamps : public FrameSource {
 public:
  explicit WithoutDepthStamps(FrameSource& source) : source_(source) {}

  std::optional<Frame> next() override {
    auto frame = source_.next();
    if (frame) frame->depth_stamp_ns.reset();
    return frame;
  }
  [[nodiscard]] const RgbdCamera& camera() const override { return source_.camera(); }
  [[nodiscard]] const SourceInfo& info() const override { return source_.info(); }
  [[nodiscard]] SkippedFrames skipped() const override { return source_.skipped(); }

 private:
  FrameSource& source_;
};

FinishedRun run_simulation(const SlamOptions& options, const SimulationOptions& walk = small_walk(),
                           bool with_depth_stamps = true) {
  const auto simulated = make_simulated_source("sim:room", walk, 2);
  WithoutDepthStamps stripped(*simulated);
  FrameSource* source = with_depth_stamps ? static_cast<FrameSource*>(simulated.get()) : &stripped;
  SessionOptions session_options;
  session_options.slam = options;
  session_options.record_images = false;
  Session session(*source, session_options);
  const Trajectory estimate = session.run();
  const auto ate = absolute_trajectory_error(estimate, source->info().ground_truth);
  const Slam& slam = session.slam();
  return {ate ? ate->error_m.rmse : 1e9,     slam.log().size(),      estimate.size(),
          slam.map().loop_closures().size(), slam.sensor_estimate(), simulated->truth()};
}

/// The walk mapped with default options, computed once for all tests of this file.
const FinishedRun& finished_walk() {
  static const FinishedRun kRun = run_simulation({});
  return kRun;
}

TEST(EndToEnd, AccuracyOfTheSimulatedWalk) {
  constexpr double kReached_m = 0.0058;
  EXPECT_EQ(finished_walk().tracked, finished_walk().frames);
  EXPECT_LT(finished_walk().ate_m, 1.5 * kReached_m);
}

TEST(EndToEnd, ALoopClosureHalvesTheDrift) {
  SlamOptions without_loops;
  without_loops.loop.enabled = false;
  const FinishedRun open = run_simulation(without_loops);
  EXPECT_GE(finished_walk().loops, 1U);
  EXPECT_EQ(open.loops, 0U);
  EXPECT_EQ(open.tracked, open.frames);
  EXPECT_LT(finished_walk().ate_m, open.ate_m / 2);
}

/// Other rooms and paths (sim:room:2, 3) give 31.5 and 32.2 ms, and a delay of depth of 13.3 and 14.8 ms.
TEST(EndToEnd, SelfCalibrationFindsTheTimesOfTheSensor) {
  const auto& [ate_m, frames, tracked, loops, sensor, truth] = finished_walk();
  ASSERT_GT(truth.rolling_shutter_s, 0.02);  // not in camera.yaml
  EXPECT_TRUE(sensor.used[kRollingShutter]);
  EXPECT_NEAR(sensor.sensor.corrections(kRollingShutter), truth.rolling_shutter_s, 0.0025);
  EXPECT_TRUE(sensor.used[kDepthDelay]);
  EXPECT_NEAR(sensor.sensor.corrections(kDepthDelay), truth.depth_delay_s, 0.004);
}

/// A sensor without errors but for depth images at times of their own.
TEST(EndToEnd, StampsOfDepthMakeAnExactSensorMoreAccurate) {
  SimulationOptions walk = small_walk();
  walk.noise = KinectNoise::none();
  walk.noise.depth_stamps = true;
  const FinishedRun with = run_simulation({}, walk, true), without = run_simulation({}, walk, false);
  EXPECT_EQ(with.tracked, with.frames);
  EXPECT_LT(with.ate_m, 0.95 * without.ate_m);
  EXPECT_NEAR(with.sensor.sensor.corrections(kDepthDelay), 0, 0.001);
}

}  // namespace
}  // namespace kinloop
