#pragma once

#include "kinloop/back_end/options.hpp"
#include "kinloop/features/options.hpp"
#include "kinloop/loop/options.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/mapping/mapper.hpp"
#include "kinloop/sensor/noise_model.hpp"
#include "kinloop/tracking/tracker.hpp"

namespace kinloop {

/// Options of a whole run.
struct SlamOptions {
  int seed = 1;
  int min_initial_keypoints = 60;
  int lost_frames_before_new_component = 5;
  double max_predicted_sigma_m = 0.1;
  bool global_ba_enabled = true;
  int global_ba_max_keyframes = 400;
  bool localize_only = false;
  int keyframe_memory_mib = 1024;
  NoiseOptions noise;
  FeatureOptions features;
  TrackingOptions tracking;
  LocalMapOptions local_map;
  MappingOptions mapping;
  LoopOptions loop;
  BundleOptions global_ba = {.tolerance = 1e-3};  // a smaller change is below measurement noise
  SelfCalibrationOptions self_calibration;
  ExecutorOptions executor;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("seed", self.seed, "random seed", Range{0, 1e9});
    visit("min_initial_keypoints", self.min_initial_keypoints,
          "minimum keypoints with depth to initialise the map", Range{10, 10000}, Expert{});
    visit("lost_frames_before_new_component", self.lost_frames_before_new_component,
          "consecutive lost frames before a new map component is started, to be merged when a "
          "place is recognised; 0 = never",
          Range{0, 100000});
    visit(
        "max_predicted_sigma_m", self.max_predicted_sigma_m,
        "largest standard deviation of the position of a frame that is predicted from the motion before and "
        "after, or carried on by dense odometry, m; beyond it the pose is doubtful",
        Range{0, 10});
    visit("global_ba_enabled", self.global_ba_enabled,
          "run global bundle adjustment after loop closures and at the end");
    visit("global_ba_max_keyframes", self.global_ba_max_keyframes,
          "largest map for which it runs after loop closures: its copy delays a frame", Range{0, 1e6},
          Expert{});
    visit("localize_only", self.localize_only, "localise in a loaded map without changing it", Expert{});
    visit(
        "keyframe_memory_mib", self.keyframe_memory_mib,
        "memory for descriptors and patches of keyframes before the oldest are spilled to a temporary file, "
        "MiB",
        Range{0, 1e6});
    visit("noise", self.noise);
    visit("features", self.features);
    visit("tracking", self.tracking);
    visit("local_map", self.local_map);
    visit("mapping", self.mapping);
    visit("loop", self.loop);
    visit("global_ba", self.global_ba);
    visit("self_calibration", self.self_calibration);
    visit("executor", self.executor);
  }

  static OptionHistory history();
};

// The part of the options that each module uses.
TrackerOptions tracker_options(const SlamOptions& options);
MapperOptions mapper_options(const SlamOptions& options);
PlaceOptions place_options(const SlamOptions& options);
BackEndOptions back_end_options(const SlamOptions& options);

}  // namespace kinloop
