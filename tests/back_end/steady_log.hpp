#pragma once
// The log of a camera that moves steadily, for tests of what is decided at the end of a run.

#include <memory>

#include <gtest/gtest.h>

#include "kinloop/core/time.hpp"
#include "kinloop/features/features.hpp"
#include "kinloop/map/frames/frame_log.hpp"

namespace kinloop::test {

/// At 30 Hz and 0.6 m/s along x, relative to keyframe 0. Keyframe 1 is of another component.
class SteadyLog : public testing::Test {
 protected:
  explicit SteadyLog(uint32_t frames) {
    const auto features = std::make_shared<const Features>();
    map_.add_keyframe(FrameId{0}, 0, SE3(), features, 0);
    map_.add_keyframe(FrameId{1}, 1, SE3(), features, 1);
    for (uint32_t i = 0; i < frames; ++i) {
      LoggedFrame& entry = log_.emplace_back();
      entry.id = FrameId{i};
      entry.stamp_ns = int64_t{i} * kNsPerSecond / 30;
      entry.outcome = TrackingOutcome::kTracked;
      entry.reference = KeyframeId{0};
      entry.T_reference_camera.translation.x() = x_m(i);
    }
  }

  static double x_m(size_t frame) { return 0.02 * static_cast<double>(frame); }

  Map map_;
  FrameLog log_;
};

}  // namespace kinloop::test
