#pragma once

#include "kinloop/features/options.hpp"
#include "kinloop/loop/options.hpp"
#include "kinloop/map/local_view.hpp"
#include "kinloop/mapping/options.hpp"
#include "kinloop/slam/self_calibration.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

/// How slow work runs beside tracking.
struct ExecutorOptions {
  std::string mode = "lagged";
  int local_lag_frames = 5;
  int verify_lag_frames = 3;
  int loop_lag_frames = 8;
  int full_lag_frames = 30;
  int dense_lag_frames = 5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("mode", self.mode,
          "inline: slow work is done at once; lagged: beside tracking, applied a fixed number of frames "
          "later (same "
          "result every run); live: applied when ready",
          Choices{{"inline", "lagged", "live"}});
    visit("local_lag_frames", self.local_lag_frames, "frames until a local adjustment is applied",
          Range{1, 1000});
    visit("verify_lag_frames", self.verify_lag_frames, "frames until a loop counts as verified",
          Range{1, 1000});
    visit("loop_lag_frames", self.loop_lag_frames, "frames until a loop correction is applied",
          Range{1, 1000});
    visit("full_lag_frames", self.full_lag_frames, "frames until a full adjustment is applied",
          Range{1, 1000});
    visit("dense_lag_frames", self.dense_lag_frames, "frames until the surface of a keyframe is there",
          Range{1, 1000});
  }
};

struct SlamOptions {
  int seed = 1;
  int min_start_points = 60;
  int lost_frames_before_component = 5;
  bool full_adjustment = true;
  bool localize_only = false;
  FeatureOptions features;
  TrackingOptions tracking;
  LocalViewOptions view;
  MappingOptions mapping;
  LoopOptions loop;
  BundleOptions full = {.tolerance = 1e-3};  // less moves nothing that could be measured
  SelfCalibrationOptions self_calibration;
  ExecutorOptions executor;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("seed", self.seed, "of all random numbers", Range{0, 1e9});
    visit("min_start_points", self.min_start_points,
          "key points with depth that the first keyframe must have", Range{10, 10000});
    visit("lost_frames_before_component", self.lost_frames_before_component,
          "frames in a row that must be lost before a new component of the map is begun, to be joined when a "
          "place is recognised; 0 = never",
          Range{0, 100000});
    visit("full_adjustment", self.full_adjustment, "adjust the whole map after loops and at the end");
    visit("localize_only", self.localize_only,
          "only tell where the frames are in a map that was loaded, and leave the map as it is");
    visit("features", self.features);
    visit("tracking", self.tracking);
    visit("view", self.view);
    visit("mapping", self.mapping);
    visit("loop", self.loop);
    visit("full", self.full);
    visit("self_calibration", self.self_calibration);
    visit("executor", self.executor);
  }
};

}  // namespace kinloop
