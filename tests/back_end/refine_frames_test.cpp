#include "kinloop/back_end/final/refine_frames.hpp"

#include <gtest/gtest.h>

#include "kinloop/slam/slam.hpp"
#include "tests/slam/recording.hpp"

namespace kinloop {
namespace {

/// A run over the first frames of the simulated room, not finished.
struct Run {
  test::Recording recording = test::record_simulation("sim:room", 30);
  SlamOptions options;
  Slam slam{recording.camera, options};

  Run() {
    for (const Frame& frame : recording.frames) slam.process(frame);
  }

  [[nodiscard]] FrameRefinement refinement() const {
    return {slam.map(), slam.sensor(), options.tracking.pose};
  }
};

const Run& run() {
  static const Run kRun;
  return kRun;
}

/// The log of the run as it is if the limiter is applied after each frame.
FrameLog limited_log(const LogLimits& limits) {
  LogLimiter limiter(limits);
  FrameLog log;
  for (const LoggedFrame& entry : run().slam.log()) {
    log.push_back(entry);
    limiter.apply(log, 0, run().refinement());
  }
  return log;
}

/// The log as it is at the end of the run.
FrameLog finished(const FrameLog& log) {
  return refine_frames(log, run().refinement(), FrameSelection::kAll, 1);
}

TEST(LogLimiter, RefinesOldFramesAsTheEndOfTheRunWould) {
  constexpr size_t kKept = 8;
  const FrameLog& tracked = run().slam.log();
  const FrameLog limited = limited_log({kKept, 100});
  const FrameLog limited_end = finished(limited), unlimited_end = finished(tracked);
  ASSERT_EQ(limited.size(), tracked.size());
  double moved_m = 0, off_m = 0;
  for (size_t i = 0; i < limited.size(); ++i) {
    SCOPED_TRACE(i);
    const bool old = i + kKept < limited.size(), observed = !tracked[i].measurements.empty();
    EXPECT_EQ(limited[i].measurements.empty(), old || !observed);
    EXPECT_EQ(limited[i].refined, old && observed);
    const Map& map = run().slam.map();
    const SE3 expected = unlimited_end[i].world(map);
    off_m = std::max(off_m, (limited_end[i].world(map).translation - expected.translation).norm());
    moved_m = std::max(moved_m, (tracked[i].world(map).translation - expected.translation).norm());
  }
  EXPECT_GT(moved_m, 1e-3) << "nothing was refined";
  // The velocity, by which 30 ms of readout are compensated, comes from neighbours that are refined or not.
  EXPECT_LT(off_m, moved_m / 4);
}

TEST(LogLimiter, ChangesNothingWithinItsLimits) {
  const FrameLog limited = limited_log({run().slam.log().size(), 100});
  ASSERT_EQ(limited.size(), run().slam.log().size());
  for (size_t i = 0; i < limited.size(); ++i) {
    EXPECT_EQ(limited[i].measurements.size(), run().slam.log()[i].measurements.size());
    EXPECT_EQ(limited[i].T_reference_camera.translation, run().slam.log()[i].T_reference_camera.translation);
  }
}

TEST(LogLimiter, KeepsTheFeaturesOfTheLatestLostFrames) {
  LogLimiter limiter({100, 3});
  FrameLog log;
  for (uint32_t i = 0; i < 10; ++i) {
    LoggedFrame& entry = log.emplace_back();
    entry.id = FrameId{i};
    if (i % 2 == 0) entry.lost = std::make_shared<const Frame>();
    limiter.apply(log, 0, run().refinement());
  }
  std::vector<uint32_t> kept;
  for (const LoggedFrame& entry : log) {
    if (entry.lost) kept.push_back(entry.id.value);
  }
  EXPECT_EQ(kept, (std::vector<uint32_t>{4, 6, 8}));
}

}  // namespace
}  // namespace kinloop
