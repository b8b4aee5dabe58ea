#pragma once

#include "kinloop/back_end/self_calibration.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/loop/options.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

/// When background jobs run and when their results are applied.
enum class ExecutorMode { kInline, kLagged, kLive };

constexpr auto option_names(ExecutorMode) {
  return std::to_array<EnumName<ExecutorMode>>(
      {{ExecutorMode::kInline, "inline"}, {ExecutorMode::kLagged, "lagged"}, {ExecutorMode::kLive, "live"}});
}

/// Execution of slow work beside tracking.
struct ExecutorOptions {
  ExecutorMode mode = ExecutorMode::kLagged;
  int local_ba_lag_frames = 5;
  int loop_verification_lag_frames = 3;
  int loop_correction_lag_frames = 8;
  int global_ba_lag_frames = 30;
  int dense_lag_frames = 5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("mode", self.mode,
          "inline: run background jobs synchronously; lagged: run them in parallel and apply results a fixed "
          "number of frames later (same result every run); live: apply results when ready");
    visit("local_ba_lag_frames", self.local_ba_lag_frames,
          "frames until a local bundle adjustment is applied", Range{1, 1000}, Expert{});
    visit("loop_verification_lag_frames", self.loop_verification_lag_frames,
          "frames until a loop verification is applied", Range{1, 1000}, Expert{});
    visit("loop_correction_lag_frames", self.loop_correction_lag_frames,
          "frames until a loop correction is applied", Range{1, 1000}, Expert{});
    visit("global_ba_lag_frames", self.global_ba_lag_frames,
          "frames until a global bundle adjustment is applied", Range{1, 1000}, Expert{});
    visit("dense_lag_frames", self.dense_lag_frames, "frames until a keyframe's surfels are applied",
          Range{1, 1000}, Expert{});
  }
};

/// What the jobs of the back end use.
struct BackEndOptions {
  ExecutorOptions executor;
  TrackingOptions tracking;
  LocalMapOptions local_map;
  MappingOptions mapping;
  LoopOptions loop;
  BundleOptions global_ba;
  bool global_ba_enabled = true;
  int global_ba_max_keyframes = 400;  ///< during the run
  SelfCalibrationOptions self_calibration;
};

}  // namespace kinloop
