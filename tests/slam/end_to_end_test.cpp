// Whole short sequences through Slam: accuracy, the effect of a loop closure, and self-calibration.

#include <gtest/gtest.h>

#include "kinloop/slam/session.hpp"
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

FinishedRun run_simulation(const SlamOptions& options) {
  const auto source = make_simulated_source("sim:room", small_walk(), 2);
  SessionOptions session_options;
  session_options.slam = options;
  session_options.record_images = false;
  Session session(*source, session_options);
  const Trajectory estimate = session.run();
  const auto ate = absolute_trajectory_error(estimate, source->info().ground_truth);
  const Slam& slam = session.slam();
  return {ate ? ate->error_m.rmse : 1e9,  slam.log().size(), estimate.size(),
          slam.map().loop_edges().size(), slam.sensor(),     source->truth()};
}

/// The walk mapped with default options, computed once for all tests of this file.
const FinishedRun& finished_walk() {
  static const FinishedRun kRun = run_simulation({});
  return kRun;
}

TEST(EndToEnd, AccuracyOfTheSimulatedWalk) {
  constexpr double kAteWhenWritten_m = 0.0072;
  EXPECT_EQ(finished_walk().tracked, finished_walk().frames);
  EXPECT_LT(finished_walk().ate_m, 2 * kAteWhenWritten_m);
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

TEST(EndToEnd, SelfCalibrationFindsTheReadoutTime) {
  const auto& [ate_m, frames, tracked, loops, sensor, truth] = finished_walk();
  ASSERT_GT(truth.rolling_shutter_s, 0.02);  // not in camera.yaml
  EXPECT_TRUE(sensor.used[kRollingShutter]);
  EXPECT_NEAR(sensor.value(kRollingShutter), truth.rolling_shutter_s, 0.005);
  EXPECT_TRUE(sensor.used[kDepthDelay]);
  EXPECT_GT(sensor.value(kDepthDelay), 0.5 * truth.depth_offset_s);
}

}  // namespace
}  // namespace kinloop
